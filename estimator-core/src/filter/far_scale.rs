//! A vehicle far from its parameters.
//!
//! A file written for a full truck that drives empty is wrong by many sigmas of the scale's prior.
//! A filter that believes such a prior takes its sensors for noisy and settles between the two.
//! Where the scale has gone further than three sigmas, it is the prior that was too narrow: the
//! scale becomes as unsure as it has moved, which is the prior under which that was most likely
//! (empirical Bayes), and again at twice the way.

use super::state::{SCALE, State};
use crate::scalar::Scalar;

/// Sigmas of the prior beyond which it is not believed: three vehicles in a thousand are beyond.
const BELIEVED_SIGMAS: f32 = 3.0;

/// How far the scale is from where it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct FarScale {
    /// Where it began.
    prior: f32,
    /// How far it may go.
    limit: f32,
    /// Variance that was added to the prior's.
    added: f32,
}

impl FarScale {
    /// Nothing is known.
    pub(super) const fn new() -> Self {
        Self {
            prior: 0.0,
            limit: f32::INFINITY,
            added: 0.0,
        }
    }

    /// Variance that the prior lacked.
    pub(super) const fn added(&self) -> f32 {
        self.added
    }

    /// The same before its start, where that variance is part of the prior.
    pub(super) const fn anew(&self) -> Self {
        Self {
            added: self.added,
            ..Self::new()
        }
    }

    /// Begins with what a state says of the scale.
    pub(super) fn begin<S: Scalar>(&mut self, state: &State<S>) {
        self.prior = state.x[SCALE].to_f32();
        self.limit = BELIEVED_SIGMAS * state.sigma(SCALE).to_f32();
    }

    /// Widens what a state knows of the scale, where that has gone too far. Whether it did.
    pub(super) fn widen<S: Scalar>(&mut self, state: &mut State<S>) -> bool {
        let away = (state.x[SCALE].to_f32() - self.prior).abs();
        let is_far = away > self.limit;
        if is_far {
            self.limit = 2.0 * away;
            self.added = away * away;
            state.p.add_variance(SCALE, S::from_f32(self.added));
        }
        is_far
    }
}
