//! Bounds of the scale, which physics gives.
//!
//! Torque that is late, held or smoothed changes when the acceleration does not. Such changes read as
//! a vehicle that hardly answers its engine: as one of a mass that no vehicle has. Where the scale
//! leaves its bounds, the changes of traction are what misleads it. They show nothing from then on,
//! and climbs alone show the scale.

use super::state::State;
use super::state_index::StateIndex::Scale;
use crate::scalar::Scalar;
use crate::tuning::Prior;

/// Whether the changes of traction have led the scale out of its bounds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ScaleBounds {
    changes_mislead: bool,
}

impl ScaleBounds {
    /// Returns whether changes of traction show nothing of the scale.
    pub(super) const fn changes_mislead(&self) -> bool {
        self.changes_mislead
    }

    /// Brings the scale back if it is out of its bounds: it is set anew.
    pub(super) fn keep<S: Scalar>(&mut self, state: &mut State<S>, tuning: &Prior) -> KeptScale {
        let scale = 1.0 + state.mean[Scale].to_f32();
        let bounded = Scalar::min(tuning.scale_high, Scalar::max(tuning.scale_low, scale));
        // While little is known of it, it passes its bounds on the way to where it is. Not once it is
        // set to them: that widens its sigma each time.
        let beyond = (scale - bounded).abs();
        if beyond == 0.0 || (!self.changes_mislead && beyond <= 0.5 * state.sigma(Scale).to_f32()) {
            return KeptScale::Within;
        }
        let covariance = &mut state.covariance;
        if self.changes_mislead {
            let moved = S::from_f32(bounded - scale);
            let variance = covariance.variance(Scale) + moved * moved;
            state.mean[Scale] += moved;
            covariance.clear(Scale);
            covariance.add_variance(Scale, variance);
            return KeptScale::AtBound;
        }
        self.changes_mislead = true;
        state.mean[Scale] = S::ZERO;
        covariance.clear(Scale);
        let sigma = S::from_f32(tuning.any_load_scale_sigma);
        covariance.add_variance(Scale, sigma * sigma);
        KeptScale::Unknown
    }
}

/// What was done with the scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeptScale {
    /// Nothing.
    Within,
    /// It was set to its bound.
    AtBound,
    /// The changes of traction were found to mislead it: it is unknown again.
    Unknown,
}
