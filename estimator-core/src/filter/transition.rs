//! One cell of driving: the vehicle and the noise in numbers.

use super::doubt::Felt;
use super::motion::Motion;
use super::state::{BIAS, ENERGY, GNSS_ERROR, SCALE, SLOPE_RATE, State, WIND};
use crate::sampler::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{GRAVITY, VehicleParameters};

/// One step: how the states move, what drives them, and what variance that adds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<S> {
    /// The linear part.
    motion: Motion<S>,
    /// Specific traction less rolling resistance and effects, times length, m²/s²: the input.
    work: S,
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

/// Variance of the bias for a vehicle at a speed, %².
///
/// Wind and auxiliaries are forces and weigh less on a heavy vehicle; tyres and shape go with
/// their resistance.
pub(super) fn bias_variance(vehicle: &VehicleParameters, tuning: &Tuning, sample: &Sample) -> f32 {
    let weight_n = sample.load.mass_kg * GRAVITY;
    let force = tuning.bias_force_n / weight_n;
    let rolling = tuning.bias_rolling * vehicle.rolling_resistance;
    let drag = tuning.bias_drag * drag_n(vehicle, sample) / weight_n;
    1e4 * (force * force + rolling * rolling + drag * drag)
}

/// Variance of what the wind's coming and going makes of air resistance, %².
pub(super) fn wind_variance(vehicle: &VehicleParameters, tuning: &Tuning, sample: &Sample) -> f32 {
    let weight_n = sample.load.mass_kg * GRAVITY;
    let speed = sample.place.speed_mps;
    let per_mps_n = vehicle.drag_area_m2 * sample.load.air_density * speed;
    let sigma = 100.0 * per_mps_n * tuning.wind_sigma_mps / weight_n;
    sigma * sigma
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
        felt: Felt,
    ) -> Self {
        let length_m = sample.length_m;
        let balance = vehicle.force_balance(&sample.load);
        let drag = balance.drag * length_m;
        let gravity = balance.gravity * length_m;
        let accelerated_kg = sample.load.mass_kg + sample.load.rotating_kg;
        let effects = felt.force_n / accelerated_kg;

        let force_percent = 100.0 * tuning.force_noise_n / (sample.load.mass_kg * GRAVITY);
        let model_percent = if sample.place.condition.is_valid() {
            force_percent
        } else {
            tuning.invalid_noise_percent
        };
        let energy_sigma = gravity * model_percent;

        // First-order Gauss-Markov processes: x+ = k x + w, var w = (1 - k²) var x.
        let markov = |steps: f32, variance: f32| {
            let keep = 1.0 / (1.0 + steps);
            (keep, (1.0 - keep * keep) * variance)
        };
        let (keep_rate, rate_noise) = markov(
            length_m / tuning.slope_rate_length_m,
            tuning.slope_rate_sigma * tuning.slope_rate_sigma,
        );
        let (keep_bias, bias_noise) = markov(
            length_m / tuning.bias_length_m,
            bias_variance(vehicle, tuning, sample),
        );
        let (keep_wind, wind_noise) = markov(
            length_m / tuning.wind_length_m,
            wind_variance(vehicle, tuning, sample),
        );
        let (keep_gnss_error, gnss_noise) = markov(
            sample.duration_s / tuning.gnss_error_time_s,
            gnss_error_spread * tuning.gnss_error_sigma_m * tuning.gnss_error_sigma_m,
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
        // Not `clamp`, which panics if the tuning is nonsense.
        let load_jump = change - Scalar::min(of_the_road, Scalar::max(-of_the_road, change));

        Self {
            motion: Motion {
                half_length: S::from_f32(0.5 * length_m),
                // exp(-drag) to second order.
                keep_energy: S::from_f32(1.0 - drag * (1.0 - 0.5 * drag)),
                load: S::from_f32(load_after),
                load_jump: S::from_f32(load_jump),
                gravity: S::from_f32(gravity),
                keep_rate: S::from_f32(keep_rate),
                keep_bias: S::from_f32(keep_bias),
                keep_wind: S::from_f32(keep_wind),
                keep_gnss_error: S::from_f32(keep_gnss_error),
            },
            work: S::from_f32((balance.traction - balance.rolling - effects) * length_m),
            noise: Noise {
                energy: S::from_f32(energy_sigma * energy_sigma),
                slope_rate: S::from_f32(rate_noise),
                bias: S::from_f32(bias_noise + felt.doubt),
                wind: S::from_f32(wind_noise),
                scale: S::from_f32(walk * walk * length_m * 0.001),
                gnss_error: S::from_f32(gnss_noise),
            },
        }
    }

    /// Predicts mean and covariance to the end of the cell.
    #[inline]
    pub fn predict(&self, state: &mut State<S>) {
        self.motion.forward(state);
        state.x[ENERGY] += self.work;
        state.x[ENERGY] = state.x[ENERGY].max(S::ZERO);
        state.p.add_variance(ENERGY, self.noise.energy);
        state.p.add_variance(SLOPE_RATE, self.noise.slope_rate);
        state.p.add_variance(BIAS, self.noise.bias);
        state.p.add_variance(WIND, self.noise.wind);
        state.p.add_variance(SCALE, self.noise.scale);
        state.p.add_variance(GNSS_ERROR, self.noise.gnss_error);
    }

    /// The linear part.
    pub(super) const fn motion(&self) -> &Motion<S> {
        &self.motion
    }
}
