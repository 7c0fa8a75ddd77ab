//! Process noise: the matrix Q, which is diagonal, and the Gauss-Markov processes behind it.

use super::error_levels::Levels;
use super::gauss_markov::GaussMarkov;
use super::state_index::PerState;
use super::traction_timing::LateTraction;
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;

/// What has been learned of the noise, as ratios of learned to assumed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LearnedNoise {
    /// Levels of the coloured errors.
    pub levels: Levels,
    /// Variance of the receiver's coloured error.
    pub gnss_error_ratio: f32,
    /// Variance of the white noise of the force.
    pub force_ratio: f32,
    /// Whether the vehicle launches with a load that is not known yet.
    pub launches: bool,
    /// Whether changes of traction show nothing of the scale.
    pub changes_mislead: bool,
    /// Modelled over true mass: a force weighs more on a vehicle that is lighter than its model.
    pub load_factor: f32,
    /// What the traction lacks because it is late.
    pub late_traction: LateTraction,
}

impl LearnedNoise {
    /// Nothing learned.
    pub(super) const NONE: Self = Self {
        levels: Levels::ASSUMED,
        gnss_error_ratio: 1.0,
        force_ratio: 1.0,
        launches: false,
        changes_mislead: false,
        load_factor: 1.0,
        late_traction: LateTraction::NONE,
    };
}

/// The coloured states over one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColouredStates {
    pub slope_rate: GaussMarkov,
    pub bias: GaussMarkov,
    pub wind: GaussMarkov,
    pub gnss_error: GaussMarkov,
}

impl ColouredStates {
    /// Returns their steps over the cell of a sample.
    #[inline(always)] // In Prediction::new, so that weight and air resistance are computed once.
    pub(super) fn over(context: &Context, sample: &Sample, learned: &LearnedNoise) -> Self {
        let levels = &learned.levels;
        let process = &context.tuning.process_noise;
        let measurement = &context.tuning.measurement_noise;
        Self {
            slope_rate: GaussMarkov::step(
                sample.length_m / process.slope_rate_length_m,
                process.slope_rate_sigma * process.slope_rate_sigma,
            ),
            bias: GaussMarkov::step(
                sample.length_m / process.bias_length_m,
                bias_variance(context, sample, learned.load_factor),
            ),
            wind: GaussMarkov::step(
                sample.length_m / (levels.wind_length_ratio * process.wind_length_m),
                levels.wind_ratio * wind_variance(context, sample, learned.load_factor),
            ),
            gnss_error: GaussMarkov::step(
                sample.duration_s / (levels.receiver_time_ratio * measurement.gnss_error_time_s),
                learned.gnss_error_ratio
                    * measurement.gnss_error_sigma_m
                    * measurement.gnss_error_sigma_m,
            ),
        }
    }
}

/// Returns the diagonal of Q for the cell of a sample.
///
/// `gravity` is the energy that a slope of 1 % costs over the cell, m²/s². `effect_variance` is what
/// uncertain effects add to the bias, %². While the model does not hold (shift, brake, no traction)
/// the energy has the noise of a slope of [`invalid_noise_percent`]; this is the noise switching of
/// the thesis (section 3).
///
/// [`invalid_noise_percent`]: crate::tuning::ProcessNoise::invalid_noise_percent
#[inline]
pub(super) fn process_noise<S: Scalar>(
    context: &Context,
    sample: &Sample,
    coloured: &ColouredStates,
    (gravity, timing_variance): (f32, f32),
    (effect_variance, scale_variance): (f32, f32),
    learned: &LearnedNoise,
) -> PerState<S> {
    let tuning = &context.tuning.process_noise;
    let model_variance = if sample.end.condition.is_valid() {
        let percent = 100.0 * tuning.force_noise_n * learned.load_factor / sample.forces.weight_n();
        // In low gears most of the torque turns the engine itself.
        let forces = &sample.forces;
        let turning_n = forces.traction_n * forces.rotating_kg / forces.accelerated_kg();
        let turning = 100.0 * tuning.inertia_noise * turning_n / forces.weight_n();
        learned.force_ratio * percent * percent + turning * turning
    } else {
        tuning.invalid_noise_percent * tuning.invalid_noise_percent
    };
    let energy_variance = gravity * gravity * (model_variance + timing_variance);
    let walk = tuning.scale_walk_per_sqrt_km;
    PerState {
        kinetic_energy: S::from_f32(energy_variance),
        altitude: S::ZERO,
        slope: S::ZERO,
        slope_rate: S::from_f32(coloured.slope_rate.variance),
        bias: S::from_f32(coloured.bias.variance + effect_variance),
        wind: S::from_f32(coloured.wind.variance),
        scale: S::from_f32(walk * walk * sample.length_m * 0.001 + scale_variance),
        gnss_error: S::from_f32(coloured.gnss_error.variance),
    }
}

/// Returns the variance of the bias of this vehicle at this speed, %².
///
/// Wind and auxiliaries are forces, which weigh less on a heavy vehicle. Errors of tyres and shape
/// are proportional to their resistance.
#[inline(never)] // Several places call it.
pub(super) fn bias_variance(context: &Context, sample: &Sample, load_factor: f32) -> f32 {
    let tuning = &context.tuning.process_noise;
    let vehicle = &context.model.vehicle;
    let weight_n = sample.forces.weight_n();
    let force = load_factor * tuning.bias_force_n / weight_n;
    let rolling = tuning.bias_rolling * vehicle.rolling_resistance;
    let drag_n = vehicle.drag_n(&sample.forces, sample.end.speed_mps);
    let drag = load_factor * tuning.bias_drag * drag_n / weight_n;
    1e4 * (force * force + rolling * rolling + drag * drag)
}

/// Returns the variance of what changing wind makes of air resistance, %²: the derivative of thesis
/// eq. 5 with respect to the speed, times the wind's sigma.
pub(super) fn wind_variance(context: &Context, sample: &Sample, load_factor: f32) -> f32 {
    let speed = sample.end.speed_mps;
    let per_mps_n = context.model.vehicle.drag_area_m2 * sample.forces.air_density * speed;
    let wind_mps = context.tuning.process_noise.wind_sigma_mps;
    let sigma = 100.0 * per_mps_n * wind_mps * load_factor / sample.forces.weight_n();
    sigma * sigma
}
