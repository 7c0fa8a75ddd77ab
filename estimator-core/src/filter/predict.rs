//! The prediction over one cell: dynamics, input and process noise in numbers of the vehicle.

use super::dynamics::Dynamics;
use super::effect_uncertainty::EffectContribution;
use super::net_traction::{gained_mps2, net_traction_percent};
use super::process_noise::{ColouredStates, LearnedNoise, process_noise};
use super::state::State;
use super::state_index::{PerState, StateIndex};
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::vehicle::GRAVITY;

/// A prediction: F, the input, and Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction<S> {
    dynamics: Dynamics<S>,
    /// The input: specific traction less rolling resistance and effects, times length, m²/s².
    work: S,
    noise: PerState<S>,
}

impl<S: Scalar> Prediction<S> {
    /// Creates the prediction over the cell of a sample, from a state if there is one.
    ///
    /// A cruise control answers the road, so its force is no input from outside. Regressing the
    /// speed on that force, with the slope as the noise, would pull the scale towards zero, the more
    /// the stiffer the road model is. Therefore the slope that the model reads at its nominal scale
    /// is the state that the road model and the speed describe, and the scale's error enters where
    /// that slope becomes climb: GNSS observes it. Only a force that changes faster than roads bend
    /// (coasting begins, a gear is in) is an input. Then the slope of the road stays, and the slope
    /// that is read steps by the scale's error.
    #[inline]
    #[must_use]
    pub(super) fn new(
        context: &Context,
        sample: &Sample,
        from: Option<&State<S>>,
        learned: &LearnedNoise,
        effects: EffectContribution,
    ) -> Self {
        let length_m = sample.length_m;
        let balance = context.model.vehicle.force_balance(&sample.forces);
        let drag = balance.drag * length_m;
        let gravity = balance.gravity * length_m;
        let effects_per_kg = effects.force_n / sample.forces.accelerated_kg();
        let coloured = ColouredStates::over(context, sample, learned);
        let traction = NetTraction::over(context, sample, from, learned);
        Self {
            dynamics: Dynamics {
                half_length: S::from_f32(0.5 * length_m),
                // exp(-drag) to second order.
                keep_energy: S::from_f32(1.0 - drag * (1.0 - 0.5 * drag)),
                net_traction: S::from_f32(traction.percent),
                traction_jump: S::from_f32(traction.jump_percent),
                gravity: S::from_f32(gravity),
                keep_slope_rate: S::from_f32(coloured.slope_rate.keep),
                keep_bias: S::from_f32(coloured.bias.keep),
                keep_wind: S::from_f32(coloured.wind.keep),
                keep_gnss_error: S::from_f32(coloured.gnss_error.keep),
            },
            work: S::from_f32(
                (balance.traction - balance.rolling - effects_per_kg) * length_m
                    + gravity * learned.late_traction.percent,
            ),
            noise: process_noise(
                context,
                sample,
                &coloured,
                (gravity, traction.timing_variance),
                (effects.bias_variance, traction.scale_variance),
                learned,
            ),
        }
    }

    /// Creates the prediction over the cell of a sample where nothing has been learned.
    #[must_use]
    pub fn of_first_cell(context: &Context, sample: &Sample, effects: EffectContribution) -> Self {
        Self::new(context, sample, None, &LearnedNoise::NONE, effects)
    }

    /// Predicts mean and covariance to the end of the cell.
    #[inline]
    pub fn apply(&self, state: &mut State<S>) {
        self.dynamics.forward(state);
        let energy = &mut state.mean[StateIndex::KineticEnergy];
        *energy += self.work;
        *energy = energy.max(S::ZERO);
        let PerState {
            kinetic_energy,
            altitude: _, // Altitude and slope are integrals of other states.
            slope: _,
            slope_rate,
            bias,
            wind,
            scale,
            gnss_error,
        } = self.noise;
        let covariance = &mut state.covariance;
        covariance.add_variance(StateIndex::KineticEnergy, kinetic_energy);
        covariance.add_variance(StateIndex::SlopeRate, slope_rate);
        covariance.add_variance(StateIndex::Bias, bias);
        covariance.add_variance(StateIndex::Wind, wind);
        covariance.add_variance(StateIndex::Scale, scale);
        covariance.add_variance(StateIndex::GnssError, gnss_error);
    }

    /// Returns the motion that the force model predicts from a state.
    pub(super) fn motion(&self, state: &State<S>, length_m: f32) -> ModelMotion {
        let mean = &state.mean;
        let slope =
            mean[StateIndex::Slope] + self.dynamics.half_length * mean[StateIndex::SlopeRate];
        let before = mean[StateIndex::KineticEnergy];
        let after =
            self.dynamics.keep_energy * (before - self.dynamics.gravity * slope) + self.work;
        let change_mps2 = (after - before).to_f32() / length_m;
        let gravity_mps2 = 0.01 * GRAVITY * slope.to_f32();
        ModelMotion {
            change_mps2,
            gravity_mps2,
            felt_mps2: change_mps2 + gravity_mps2,
            net_traction_percent: self.dynamics.net_traction.to_f32(),
            variance: self.noise.kinetic_energy.to_f32() / (length_m * length_m),
        }
    }

    /// Returns the variance that bias and wind gain over the cell, %².
    pub(super) fn slow_variance(&self) -> f32 {
        (self.noise.bias + self.noise.wind).to_f32()
    }

    /// Adds an error of the force, m/s², 1 sigma.
    pub(super) fn add_force_noise(&mut self, sigma_mps2: f32, length_m: f32) {
        let work = sigma_mps2 * length_m;
        self.noise.kinetic_energy += S::from_f32(work * work);
    }

    /// Combines the force with a measured motion, by their variances. Returns the weight of the
    /// measured one.
    ///
    /// Either gives the energy at the end of the cell, linear in the states. So does their weighted
    /// mean.
    pub(super) fn combine(&mut self, measured: &MeasuredMotion, length_m: f32) -> f32 {
        let per_mps2 = length_m / measured.per_change;
        let variance = measured.variance * per_mps2 * per_mps2;
        let of_model = self.noise.kinetic_energy.to_f32();
        let weight = of_model / (of_model + variance);
        let part = S::from_f32(weight);
        let mix = |model: &mut S, measured: S| *model += part * (measured - *model);
        mix(
            &mut self.work,
            S::from_f32(measured.acceleration_mps2 * per_mps2),
        );
        mix(
            &mut self.dynamics.gravity,
            S::from_f32(0.01 * GRAVITY * measured.per_gravity * per_mps2),
        );
        // The air resistance is in what is measured.
        mix(&mut self.dynamics.keep_energy, S::ONE);
        self.noise.kinetic_energy = S::from_f32(weight * variance);
        weight
    }

    /// Returns F.
    #[must_use]
    pub const fn dynamics(&self) -> &Dynamics<S> {
        &self.dynamics
    }
}

/// The motion over a cell that the force model predicts.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelMotion {
    /// Change of the speed, m/s².
    pub change_mps2: f32,
    /// Gravity along the slope that the model reads, m/s².
    pub gravity_mps2: f32,
    /// Sum of both: the specific force.
    pub felt_mps2: f32,
    /// Net traction, %.
    pub net_traction_percent: f32,
    /// Variance of the change, (m/s²)².
    pub variance: f32,
}

/// A measured change of the speed plus gravity.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredMotion {
    /// Less the offset of the sensor, m/s².
    pub acceleration_mps2: f32,
    /// What the sensor reads for a change of the speed of 1 m/s².
    pub per_change: f32,
    /// The same for a gravity along the road of 1 m/s².
    pub per_gravity: f32,
    /// Variance, (m/s²)².
    pub variance: f32,
}

/// Net traction at the end of a cell, and the part of its change that no road can have caused.
struct NetTraction {
    percent: f32,
    jump_percent: f32,
    /// Variance of the slope that its wrong timing makes, %².
    timing_variance: f32,
    /// Variance of the scale that its changes leave, 1.
    scale_variance: f32,
}

impl NetTraction {
    /// A wrong mass scales all forces but those that are proportional to it; of what is unknown,
    /// the mass is the largest part. Where the model does not hold, the last value stays.
    fn over<S: Scalar>(
        context: &Context,
        sample: &Sample,
        from: Option<&State<S>>,
        learned: &LearnedNoise,
    ) -> Self {
        let gained = gained_mps2(sample, from);
        let now = net_traction_percent(context, sample, gained) + learned.late_traction.percent;
        let before = from.map_or(now, |state| state.net_traction.to_f32());
        let percent = if sample.end.condition.is_valid() {
            now
        } else {
            before
        };
        let change = percent - before;
        let tuning = &context.tuning.process_noise;
        // A driver who launches does not answer the road.
        let launches = learned.launches && gained > tuning.launch_mps2;
        let of_the_road = if launches {
            0.0
        } else {
            tuning.traction_change_percent
        };
        // Not `clamp`, which panics if the limits are in the wrong order.
        let jump_percent = change - Scalar::min(of_the_road, Scalar::max(-of_the_road, change));
        let (variance, scale) = from.map_or((0.0, 1.0), |state| {
            let variance = state.covariance.variance(StateIndex::Scale);
            let scale = 1.0 + state.mean[StateIndex::Scale].to_f32();
            (variance.to_f32(), scale)
        });
        // Where the scale is known, climbs show it better than torque in motion does.
        let least = tuning.jump_matters_percent;
        let matters = launches || variance * jump_percent * jump_percent > least * least;
        let (jump_percent, jump_noise_percent) = if learned.changes_mislead {
            (0.0, jump_percent)
        } else if matters {
            (jump_percent, tuning.jump_noise * jump_percent)
        } else {
            (0.0, 0.0)
        };
        let late_noise = learned.late_traction.noise_percent;
        // Slope and scale depend on each other since the first change of a launch, so each change
        // counts. What they show together is known no better than rotating mass and timing.
        let least = tuning.jump_scale_sigma * scale;
        let scale_variance = if launches && jump_percent != 0.0 {
            Scalar::max(least * least - variance, 0.0)
        } else {
            0.0
        };
        Self {
            percent,
            jump_percent,
            timing_variance: jump_noise_percent * jump_noise_percent + late_noise * late_noise,
            scale_variance,
        }
    }
}
