//! What belongs to the vehicle: the states that one drive leaves for the next.
//!
//! Between two drives each of them takes one Gauss-Markov step: a part of its mean is kept, and its
//! variance moves towards that of an unknown vehicle, x' = k x + w, var w = (1 − k²) σ². A chain of
//! short drives therefore forgets what it does not learn again.

use super::cell_input::CellInput;
use super::effect_uncertainty::initial_variances;
use super::state::State;
use super::state_index::StateIndex::{self, Bias, Retarder, Scale, TyreSlip};
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;

/// Mean and variance of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlowState {
    /// Mean.
    pub mean: f32,
    /// Variance.
    pub variance: f32,
}

/// The states that belong to the vehicle, as a drive knows them at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlowStates {
    /// Mass with which they were learned: as the bus reports it, else the parameter, kg.
    pub mass_kg: f32,
    /// Bias, %.
    pub bias: SlowState,
    /// Scale error: true over modelled traction per kilogram, less one.
    pub scale: SlowState,
    /// Covariance of the two, %.
    pub covariance: f32,
    /// Slip of the driven tyres over traction per weight.
    pub tyre_slip: SlowState,
    /// Error of the retarder's factor.
    pub retarder: SlowState,
}

impl SlowStates {
    /// Returns the slow part of a state that was learned with this mass in kg.
    #[must_use]
    pub fn of<S: Scalar>(state: &State<S>, mass_kg: f32) -> Self {
        let covariance = |i, j| state.covariance.get(i, j).to_f32();
        let slow = |index: StateIndex| SlowState {
            mean: state.mean[index as usize].to_f32(),
            variance: covariance(index, index),
        };
        Self {
            mass_kg,
            bias: slow(Bias),
            scale: slow(Scale),
            covariance: covariance(Bias, Scale),
            tyre_slip: slow(TyreSlip),
            retarder: slow(Retarder),
        }
    }

    /// Returns which part of the scale is kept for a drive that begins with a sample: none if it was
    /// learned for another mass.
    #[must_use]
    pub fn kept_scale(&self, context: &Context, sample: &Sample) -> f32 {
        let change_kg = (sample.forces.mass_kg - self.mass_kg).abs();
        if change_kg <= context.tuning.detection.mass_change * self.mass_kg {
            context.tuning.prior.kept_scale
        } else {
            0.0
        }
    }

    /// Takes one step from the end of that drive to the start of this one, which begins with a sample.
    /// `fresh` is what a first drive would assume.
    ///
    /// The scale consists of mass and torque. Where no message reports the mass, a truck that has
    /// loaded looks like one that has not: with probability k the scale is what it was, otherwise it
    /// is anything that a load can make it. Averaged over loads, such a mixture has the mean and
    /// variance of a Markov step. A scale that was learned for another reported load says nothing of
    /// this one.
    fn carry_over<S: Scalar>(&self, fresh: &mut State<S>, context: &Context, sample: &Sample) {
        let mut step = |index: StateIndex, of: &SlowState, keep: f32| {
            let unknown = fresh.covariance.get(index, index);
            let kept = S::from_f32(keep * keep);
            let variance = kept * S::from_f32(of.variance) + (S::ONE - kept) * unknown;
            fresh.mean[index as usize] = S::from_f32(keep * of.mean);
            fresh.covariance.add(index, index, variance - unknown);
        };
        let tuning = &context.tuning.prior;
        step(Bias, &self.bias, tuning.kept_bias);
        step(TyreSlip, &self.tyre_slip, tuning.kept_scale);
        step(Retarder, &self.retarder, tuning.kept_scale);
        let kept_scale = self.kept_scale(context, sample);
        if kept_scale > 0.0 {
            step(Scale, &self.scale, kept_scale);
            let joint = tuning.kept_bias * kept_scale * self.covariance;
            fresh.covariance.add(Bias, Scale, S::from_f32(joint));
        }
    }
}

/// Returns the state before the first cell of a drive, with what an earlier one has left. The states
/// that a gap ends are zero: the first cell sets them.
#[must_use]
pub fn initial_state<S: Scalar>(
    known: Option<&SlowStates>,
    context: &Context,
    sample: &Sample,
    cell: &CellInput,
) -> State<S> {
    let numbers = &context.tuning.estimation;
    let mut state = State::at_start(numbers, cell, 0.0);
    let (bias, scale) = initial_variances(context, sample);
    state.covariance.add(Bias, Bias, S::from_f32(bias));
    state.covariance.add(Scale, Scale, S::from_f32(scale));
    if let Some(known) = known {
        known.carry_over(&mut state, context, sample);
    }
    // Tyres are cold again, whatever the last drive found.
    let cold = 100.0 * numbers.prior_cold_tyre * context.model.vehicle.rolling_resistance;
    state.covariance.add(Bias, Bias, S::from_f32(cold * cold));
    state
}
