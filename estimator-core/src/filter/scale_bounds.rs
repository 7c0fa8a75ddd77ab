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

    /// Brings the scale back if it is out of its bounds. Returns whether the changes of traction
    /// were found to mislead it: it is then unknown again.
    pub(super) fn keep<S: Scalar>(&mut self, state: &mut State<S>, tuning: &Prior) -> bool {
        let scale = 1.0 + state.mean[Scale].to_f32();
        let bounded = Scalar::min(tuning.scale_high, Scalar::max(tuning.scale_low, scale));
        if scale == bounded {
            return false;
        }
        if self.changes_mislead {
            let moved = S::from_f32(bounded - scale);
            state.mean[Scale] += moved;
            state.covariance.add_variance(Scale, moved * moved);
            return false;
        }
        self.changes_mislead = true;
        state.mean[Scale] = S::ZERO;
        state.covariance.clear(Scale);
        let sigma = S::from_f32(tuning.any_load_scale_sigma);
        state.covariance.add_variance(Scale, sigma * sigma);
        true
    }
}
