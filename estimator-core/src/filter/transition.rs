//! One cell of driving, as shears on mean and covariance.

use super::Covariance;
use super::state::{
    ALTITUDE, BIAS, ENERGY, GNSS_ERROR, SCALE, SLOPE, SLOPE_RATE, STATES, State, WIND,
};
use crate::cell::CELL_LENGTH_M;
use crate::sampler::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{GRAVITY, VehicleParameters};

/// Coefficients of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<S> {
    /// Part of the kinetic energy that air resistance leaves.
    keep_energy: S,
    /// Rolling resistance times length, m²/s².
    rolling: S,
    /// Specific traction times length, m²/s²: the input.
    traction: S,
    /// Traction less air resistance over weight at the end of the cell, % ([`State::load`]).
    load: S,
    /// What of its change no road can have caused, %.
    load_jump: S,
    /// Specific weight times length, m²/s² for 1 %.
    gravity: S,
    /// Part of the slope rate that is left.
    keep_rate: S,
    /// Part of the bias that is left.
    keep_bias: S,
    /// Part of the wind that is left.
    keep_wind: S,
    /// Part of the coloured GNSS error that is left.
    keep_gnss_error: S,
    /// Variances that the step adds.
    noise: Noise<S>,
}

/// Variances added in one step, by state.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Noise<S> {
    energy: S,
    slope_rate: S,
    bias: S,
    wind: S,
    scale: S,
    gnss_error: S,
}

/// Standard deviation of the bias for a vehicle at a speed, %.
///
/// Wind and auxiliaries are forces and weigh less on a heavy vehicle; tyres and shape go with
/// their resistance.
pub(super) fn bias_sigma(vehicle: &VehicleParameters, tuning: &Tuning, sample: &Sample) -> f32 {
    let weight_n = sample.load.mass_kg * GRAVITY;
    let force = tuning.bias_force_n / weight_n;
    let rolling = tuning.bias_rolling * vehicle.rolling_resistance;
    let drag = tuning.bias_drag * drag_n(vehicle, sample) / weight_n;
    100.0 * libm::sqrtf(force * force + rolling * rolling + drag * drag)
}

/// Standard deviation of what the wind's coming and going makes of air resistance, %.
pub(super) fn wind_sigma(vehicle: &VehicleParameters, tuning: &Tuning, sample: &Sample) -> f32 {
    let weight_n = sample.load.mass_kg * GRAVITY;
    let speed = sample.place.speed_mps;
    let per_mps_n = vehicle.drag_area_m2 * sample.load.air_density * speed;
    100.0 * per_mps_n * tuning.wind_sigma_mps / weight_n
}

/// Air resistance, N.
fn drag_n(vehicle: &VehicleParameters, sample: &Sample) -> f32 {
    let speed = sample.place.speed_mps;
    0.5 * vehicle.drag_area_m2 * sample.load.air_density * speed * speed
}

impl<S: Scalar> Transition<S> {
    /// The step over the cell of `sample`, from a state if there is one, with the variance of the
    /// GNSS error `gnss_error_spread` times what the tuning says.
    ///
    /// A cruise control answers the road: its force is no input from outside, and regressing the
    /// speed on it (with the slope as the noise) would pull the scale towards zero, the more the
    /// stiffer the road model is. So the slope that the model reads at its nominal scale is the
    /// state that the road model and the speed speak about, and the scale's error enters where
    /// that slope becomes climb: GNSS tells it. Only a force that changes faster than roads
    /// bend (coasting begins, a gear is in) is an input: then the slope of the road stays, and
    /// the slope that is read steps by the scale's error.
    #[must_use]
    pub fn new(
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        sample: &Sample,
        from: Option<&State<S>>,
        gnss_error_spread: f32,
    ) -> Self {
        let length_m = CELL_LENGTH_M;
        let balance = vehicle.force_balance(&sample.load);
        let drag = balance.drag * length_m;
        let gravity = balance.gravity * length_m;

        let force_percent = 100.0 * tuning.force_noise_n / (sample.load.mass_kg * GRAVITY);
        let model_percent = if sample.place.condition.is_valid() {
            force_percent
        } else {
            tuning.invalid_noise_percent
        };
        let energy_sigma = gravity * model_percent;

        // First-order Gauss-Markov processes: x+ = k x + w, var w = (1 - k²) sigma².
        let markov = |steps: f32, sigma: f32| {
            let keep = 1.0 / (1.0 + steps);
            (keep, (1.0 - keep * keep) * sigma * sigma)
        };
        let (keep_rate, rate_noise) = markov(
            length_m / tuning.slope_rate_length_m,
            tuning.slope_rate_sigma,
        );
        let (keep_bias, bias_noise) = markov(
            length_m / tuning.bias_length_m,
            bias_sigma(vehicle, tuning, sample),
        );
        let (keep_wind, wind_noise) = markov(
            length_m / tuning.wind_length_m,
            wind_sigma(vehicle, tuning, sample),
        );
        let (keep_gnss_error, gnss_noise) = markov(
            sample.duration_s / tuning.gnss_error_time_s,
            // An error that stepped far out does not come back as a small one would.
            from.map_or(0.0, |state| state.x[GNSS_ERROR].to_f32().abs())
                .max(tuning.gnss_error_sigma_m * libm::sqrtf(gnss_error_spread)),
        );
        let walk = tuning.scale_walk_per_sqrt_km;

        // A wrong mass scales all forces but those that go with it; of what is unknown, mass is
        // the largest part.
        let weight_n = sample.load.mass_kg * GRAVITY;
        let load_now = 100.0 * (sample.load.traction_n - drag_n(vehicle, sample)) / weight_n;
        let load_before = from.map_or(load_now, |state| state.load.to_f32());
        let load_after = if sample.place.condition.is_valid() {
            load_now
        } else {
            load_before
        };
        let change = load_after - load_before;
        let of_the_road = tuning.load_change_percent;
        let load_jump = change - change.clamp(-of_the_road, of_the_road);

        Self {
            // exp(-drag) to second order.
            keep_energy: S::from_f32(1.0 - drag * (1.0 - 0.5 * drag)),
            rolling: S::from_f32(balance.rolling * length_m),
            traction: S::from_f32(balance.traction * length_m),
            load: S::from_f32(load_after),
            load_jump: S::from_f32(load_jump),
            gravity: S::from_f32(gravity),
            keep_rate: S::from_f32(keep_rate),
            keep_bias: S::from_f32(keep_bias),
            keep_wind: S::from_f32(keep_wind),
            keep_gnss_error: S::from_f32(keep_gnss_error),
            noise: Noise {
                energy: S::from_f32(energy_sigma * energy_sigma),
                slope_rate: S::from_f32(rate_noise),
                bias: S::from_f32(bias_noise),
                wind: S::from_f32(wind_noise),
                scale: S::from_f32(walk * walk * length_m * 0.001),
                gnss_error: S::from_f32(gnss_noise),
            },
        }
    }

    /// Predicts mean and covariance to the end of the cell.
    #[inline]
    pub fn predict(&self, state: &mut State<S>) {
        for (i, j, factor) in self.shears() {
            let step = factor * state.x[j];
            state.x[i] += step;
            state.p.shear(i, j, factor);
        }
        for (i, keep) in self.keeps() {
            state.x[i] *= keep;
            state.p.scale(i, keep);
        }
        state.x[ENERGY] += self.traction - self.rolling;
        state.x[ENERGY] = state.x[ENERGY].max(S::ZERO);
        state.load = self.load;
        state.p.add_variance(ENERGY, self.noise.energy);
        state.p.add_variance(SLOPE_RATE, self.noise.slope_rate);
        state.p.add_variance(BIAS, self.noise.bias);
        state.p.add_variance(WIND, self.noise.wind);
        state.p.add_variance(SCALE, self.noise.scale);
        state.p.add_variance(GNSS_ERROR, self.noise.gnss_error);
    }

    /// The transposed step, backwards: on the smoother's vector and matrix.
    #[inline]
    pub fn transpose(&self, lambda: &mut [S; STATES], information: &mut Covariance<S>) {
        for (i, keep) in self.keeps() {
            lambda[i] *= keep;
            information.scale(i, keep);
        }
        for (i, j, factor) in self.shears().into_iter().rev() {
            let step = factor * lambda[i];
            lambda[j] += step;
            information.shear(j, i, factor);
        }
    }

    /// Off-diagonal entries of the transition as `x_i += factor * x_j`, in order. The slope turns
    /// halfway through the cell, so that energy and altitude see its middle.
    #[inline(always)]
    fn shears(&self) -> [(usize, usize, S); 8] {
        let half = S::from_f32(0.5 * CELL_LENGTH_M);
        let climb = S::from_f32(0.01 * CELL_LENGTH_M);
        [
            (SLOPE, SCALE, -self.load_jump),
            (SLOPE, SLOPE_RATE, half),
            (ENERGY, SLOPE, -self.gravity),
            (ALTITUDE, SLOPE, climb),
            (ALTITUDE, BIAS, -climb),
            (ALTITUDE, WIND, -climb),
            (ALTITUDE, SCALE, climb * self.load),
            (SLOPE, SLOPE_RATE, half),
        ]
    }

    /// Diagonal entries that are not one.
    ///
    /// They act after the shears; the forces of the cell thus lose to air resistance a part in a
    /// thousand of what the energy does, which is nothing.
    #[inline(always)]
    fn keeps(&self) -> [(usize, S); 5] {
        [
            (ENERGY, self.keep_energy),
            (SLOPE_RATE, self.keep_rate),
            (BIAS, self.keep_bias),
            (WIND, self.keep_wind),
            (GNSS_ERROR, self.keep_gnss_error),
        ]
    }

    /// Traction less air resistance over weight at the end of the cell, %.
    pub(super) const fn load(&self) -> S {
        self.load
    }

    /// In another number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Transition<T> {
        let to = |value: S| T::from_f64(value.to_f64());
        Transition {
            keep_energy: to(self.keep_energy),
            rolling: to(self.rolling),
            traction: to(self.traction),
            load: to(self.load),
            load_jump: to(self.load_jump),
            gravity: to(self.gravity),
            keep_rate: to(self.keep_rate),
            keep_bias: to(self.keep_bias),
            keep_wind: to(self.keep_wind),
            keep_gnss_error: to(self.keep_gnss_error),
            noise: Noise {
                energy: to(self.noise.energy),
                slope_rate: to(self.noise.slope_rate),
                bias: to(self.noise.bias),
                wind: to(self.noise.wind),
                scale: to(self.noise.scale),
                gnss_error: to(self.noise.gnss_error),
            },
        }
    }
}
