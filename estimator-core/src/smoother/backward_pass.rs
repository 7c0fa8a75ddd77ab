//! The backward pass over filter steps: Bryson-Frazier as modified by Bierman.
//!
//! It carries the adjoint vector λ and its information matrix Λ, so that no covariance is inverted.
//! The smoothed mean is x − P λ and the smoothed covariance P − P Λ P, with x and P as the filter
//! had them at each cell (G. J. Bierman, "Fixed interval smoothing with discrete measurements", Int.
//! J. Control 18:65, 1973). One step costs less than one of the filter, whose gains are in the
//! record.

use crate::cell::{Estimate, Uncertain};
use crate::filter::StateIndex::{Altitude, Bias, GnssError, KineticEnergy, Scale, Slope};
use crate::filter::measurement::{Observation, ScalarUpdate};
use crate::filter::{
    Covariance, ModelMass, Quantity, QuantityEstimate, SmootherInput, State, StateVector,
};
use crate::scalar::Scalar;

/// Least part of a variance that later steps leave: a two-hundredth of its sigma. Single precision
/// knows the difference of two variances no better, and none is known exactly.
const LEAST_PART: f32 = 25e-6;

/// What later steps say about earlier ones: λ and Λ.
#[derive(Clone, Copy, Debug)]
pub struct BackwardPass<S> {
    pub(super) lambda: StateVector<S>,
    pub(super) information: Covariance<S>,
}

impl<S: Scalar> BackwardPass<S> {
    /// Creates the pass at the newest step, of which nothing later is known.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            lambda: StateVector::ZERO,
            information: Covariance::ZERO,
        }
    }

    /// Returns the smoothed estimate of a quantity, given the filter's.
    #[inline(never)] // Called from several places.
    #[must_use]
    pub fn smooth(&self, filtered: &QuantityEstimate<S>) -> QuantityEstimate<S> {
        let spread = self.information.times(&filtered.cross);
        let reduction = filtered.cross.dot(&spread);
        let least = filtered.variance * S::from_f32(LEAST_PART);
        QuantityEstimate {
            mean: filtered.mean - filtered.cross.dot(&self.lambda),
            variance: (filtered.variance - reduction).max(least),
            cross: filtered.cross,
        }
    }

    /// Returns the smoothed estimate where the filter had `state`. `mass` is that of the model
    /// there.
    #[must_use]
    pub fn estimate(&self, state: &State<S>, mass: &ModelMass) -> Estimate {
        let smoothed = |quantity| self.smooth(&state.quantity(quantity));
        let energy = self.smooth_energy(state);
        let scale = smoothed(Quantity::Scale).uncertain().plus(1.0);
        Estimate {
            grade_percent: smoothed(Quantity::Slope).grade(),
            altitude_m: smoothed(Quantity::Altitude).altitude(state.origin_m),
            speed_mps: (energy + energy).sqrt().to_f32(),
            bias_percent: smoothed(Quantity::Bias).uncertain(),
            scale,
            mass_kg: mass.gross_kg(scale),
        }
    }

    /// Returns the step of the bias here that later measurements suggest, %: by how much more the model
    /// reads slopes too high from here on. Its sigma is that of its noise, and infinite if there are no
    /// later measurements. Where the bias steps, the slope that the model reads steps by as much. The
    /// slope of the road does not.
    ///
    /// Source: P. de Jong and J. Penzer, "Diagnosing shocks in time series", Journal of the American
    /// Statistical Association 93:796, 1998.
    #[must_use]
    pub fn bias_step(&self) -> Uncertain {
        let score = -(self.lambda[Bias] + self.lambda[Slope]).to_f32();
        let joint = self.information.get(Bias, Slope);
        let information =
            self.information.variance(Bias) + self.information.variance(Slope) + joint + joint;
        let variance = 1.0 / Scalar::max(information.to_f32(), 0.0);
        Uncertain {
            value: if variance < f32::INFINITY {
                score * variance
            } else {
                0.0
            },
            sigma: Scalar::sqrt(variance),
        }
    }

    fn smooth_energy(&self, state: &State<S>) -> S {
        state.mean[KineticEnergy] - state.covariance.row(KineticEnergy).dot(&self.lambda)
    }

    /// Goes back over a step: from after its measurements to after those of the step before.
    // Within a block its fields are too far from the start for a Cortex-M0 to reach them directly.
    #[inline(never)]
    pub fn retreat(&mut self, step: &SmootherInput<S>) {
        if step.scale_set {
            step.transpose_scale(&mut self.lambda);
            self.information.clear(Scale);
        }
        // In the reverse order of the filter's updates.
        for (observation, update) in step.updates() {
            self.undo(observation, step.dynamics.net_traction, update);
        }
        if step.reset.sets_altitude() {
            self.information.shear(GnssError, Altitude, -S::ONE);
            self.information.clear(Altitude);
        }
        if step.reset.is_gap() {
            self.information.clear_after_gap();
        } else {
            step.dynamics.transpose_matrix(&mut self.information);
        }
        step.transpose_prediction(&mut self.lambda);
    }

    /// Applies λ ← (I − K h)' λ − h' ν/S and Λ ← (I − K h)' Λ (I − K h) + h' h/S. Only the states
    /// that the measurement observes change.
    fn undo(&mut self, observation: Observation, net_traction: S, update: &ScalarUpdate<S>) {
        let per_variance = S::ONE / update.innovation_variance;
        let spread = self.information.times(&update.gain);
        let within = update.gain.dot(&spread);
        update.transpose_vector(observation, net_traction, &mut self.lambda);
        let factor = -(update.innovation * per_variance);
        observation.add_to(&mut self.lambda, net_traction, factor);
        let factor = within + per_variance;
        observation.add_products(&mut self.information, net_traction, &spread, factor);
    }
}

impl<S: Scalar> Default for BackwardPass<S> {
    fn default() -> Self {
        Self::new()
    }
}
