//! The prior: what is assumed of the states where a drive begins.
//!
//! Between two drives each slow state takes one Gauss-Markov step: a part of its mean is kept, and
//! its variance moves towards that of an unknown vehicle, x' = k x + w, var w = (1 − k²) σ². A chain
//! of short drives therefore forgets what it does not learn again.

use super::covariance::Covariance;
use super::effect_uncertainty::initial_variances;
use super::process_noise::{bias_variance, wind_variance};
use super::state::State;
use super::state_index::StateIndex::{self, Bias, Scale};
use super::state_index::{PerState, StateVector};
use crate::context::Context;
use crate::sample::{Sample, SpeedMeasurement};
use crate::scalar::Scalar;
use crate::tuning::{Prior, Tuning};

/// The states that belong to the vehicle, as a drive knows them at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlowStates {
    /// Mass with which they were learned: as the bus reports it, else the parameter, kg.
    pub mass_kg: f32,
    /// Bias, %.
    pub bias_percent: f32,
    /// Its variance, %².
    pub bias_variance: f32,
    /// Scale error: true over modelled traction per kilogram, less one.
    pub scale_error: f32,
    /// Its variance, 1.
    pub scale_variance: f32,
    /// Covariance of the two, %.
    pub covariance: f32,
}

impl SlowStates {
    /// Returns the slow part of a state that was learned with this mass in kg.
    #[must_use]
    pub fn of<S: Scalar>(state: &State<S>, mass_kg: f32) -> Self {
        let covariance = |i, j| state.covariance.get(i, j).to_f32();
        Self {
            mass_kg,
            bias_percent: state.mean[Bias].to_f32(),
            bias_variance: covariance(Bias, Bias),
            scale_error: state.mean[Scale].to_f32(),
            scale_variance: covariance(Scale, Scale),
            covariance: covariance(Bias, Scale),
        }
    }

    /// Takes one step from the end of that drive to the start of this one. `fresh` is what a first
    /// drive would assume with this mass in kg.
    ///
    /// The scale consists of mass and torque. Where no message reports the mass, a truck that has
    /// loaded looks like one that has not: with probability k the scale is what it was, otherwise it
    /// is anything that a load can make it. Averaged over loads, such a mixture has the mean and
    /// variance of a Markov step. A scale that was learned for another reported load says nothing of this one.
    fn carry_over<S: Scalar>(&self, fresh: &mut State<S>, mass_kg: f32, tuning: &Prior) {
        let markov = |keep: f32, variance: f32, of_any: S| {
            let kept = S::from_f32(keep * keep);
            kept * S::from_f32(variance) + (S::ONE - kept) * of_any
        };
        let State {
            mean, covariance, ..
        } = fresh;
        let (keep_bias, keep_scale) = (tuning.kept_bias, tuning.kept_scale);
        let bias = markov(keep_bias, self.bias_variance, covariance.variance(Bias));
        mean[Bias] = S::from_f32(keep_bias * self.bias_percent);
        covariance.set(Bias, Bias, bias);
        if (mass_kg - self.mass_kg).abs() <= tuning.same_load * self.mass_kg {
            let any_load = tuning.any_load_scale_sigma;
            let scale = markov(
                keep_scale,
                self.scale_variance,
                S::from_f32(any_load * any_load),
            );
            mean[Scale] = S::from_f32(keep_scale * self.scale_error);
            covariance.set(Scale, Scale, scale);
            let joint = keep_bias * keep_scale * self.covariance;
            covariance.set(Bias, Scale, S::from_f32(joint));
        }
    }
}

/// Returns the state before the first cell of a drive. The states that a gap ends are zero: the
/// first speed sets them.
pub(super) fn initial_state<S: Scalar>(
    known: Option<&SlowStates>,
    context: &Context,
    sample: &Sample,
) -> State<S> {
    let tuning = &context.tuning;
    let square = |sigma: f32| sigma * sigma;
    let mut state = State {
        mean: StateVector::ZERO,
        covariance: Covariance::ZERO,
        net_traction: S::ZERO,
        origin_m: None,
        doubt_variance: 0.0,
    };
    let variances = PerState {
        kinetic_energy: 0.0,
        altitude: 0.0,
        slope: 0.0,
        slope_rate: 0.0,
        bias: bias_variance(context, sample, 1.0),
        wind: wind_variance(context, sample, 1.0),
        scale: square(tuning.prior.scale_sigma),
        gnss_error: square(tuning.measurement_noise.gnss_error_sigma_m),
    };
    for (index, variance) in StateIndex::ALL.into_iter().zip(variances.into_array()) {
        state.covariance.set(index, index, S::from_f32(variance));
    }
    let (bias, scale) = initial_variances(context, sample);
    state.covariance.add_variance(Bias, S::from_f32(bias));
    state.covariance.add_variance(Scale, S::from_f32(scale));
    if let Some(known) = known {
        known.carry_over(&mut state, sample.forces.mass_kg, &tuning.prior);
    }
    // Tyres are cold again, whatever the last drive found.
    let cold = cold_tyres_percent(context);
    state
        .covariance
        .add_variance(Bias, S::from_f32(cold * cold));
    state
}

/// Starts the states that a gap ends from a speed. The slow states stay as they are.
pub(super) fn start_after_gap<S: Scalar>(
    state: &mut State<S>,
    tuning: &Tuning,
    speed: SpeedMeasurement,
) {
    let square = |sigma: f32| S::from_f32(sigma * sigma);
    state.mean.clear_after_gap();
    state.covariance.clear_after_gap();
    state.origin_m = None;
    let mps = speed.mean_mps;
    state.mean[StateIndex::KineticEnergy] = S::from_f32(0.5 * mps * mps);
    // The speed itself follows as a measurement. What is set here only has to be wider.
    for (index, sigma) in [
        (StateIndex::KineticEnergy, Scalar::max(1.0, mps)),
        (StateIndex::Slope, tuning.prior.slope_sigma_percent),
        (StateIndex::SlopeRate, tuning.process_noise.slope_rate_sigma),
    ] {
        state.covariance.set(index, index, square(sigma));
    }
}

/// Widens bias and scale after a stop that may have changed the load. The means stay: there are no
/// better ones, and noise that is added leaves the smoothing as it is.
#[inline(never)] // Rare, and called from two places.
pub(super) fn reopen_bias_and_scale<S: Scalar>(
    state: &mut State<S>,
    context: &Context,
    sample: &Sample,
) {
    let bias = bias_variance(context, sample, 1.0);
    let cold = cold_tyres_percent(context);
    let scale = context.tuning.prior.scale_sigma;
    let (effect_bias, effect_scale) = initial_variances(context, sample);
    for (index, variance) in [
        (Bias, bias + cold * cold + effect_bias),
        (Scale, scale * scale + effect_scale),
    ] {
        let known = state.covariance.variance(index).to_f32();
        let lacking = Scalar::max(0.0, variance - known);
        state.covariance.add_variance(index, S::from_f32(lacking));
    }
}

/// Widens the bias after a launch that showed another load: forces weigh differently on it.
pub(super) fn reopen_bias<S: Scalar>(state: &mut State<S>, context: &Context, sample: &Sample) {
    let load_factor = 1.0 + state.mean[Scale].to_f32();
    let known = state.covariance.variance(Bias).to_f32();
    let lacking = Scalar::max(0.0, bias_variance(context, sample, load_factor) - known);
    state.covariance.add_variance(Bias, S::from_f32(lacking));
}

/// Returns the sigma of what cold tyres add to the resistance, %.
fn cold_tyres_percent(context: &Context) -> f32 {
    let rolling = context.model.vehicle.rolling_resistance;
    100.0 * rolling * context.tuning.prior.cold_tyre_rolling
}
