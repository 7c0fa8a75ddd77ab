//! A vehicle far from its parameters.
//!
//! A file written for a full truck that drives empty is wrong by many sigmas of the scale's prior.
//! A filter that believes such a prior takes its sensors for noisy and settles between the two.
//! Where the scale has been off by more than [`Tuning::scale_sigmas`] for a while, it is the prior
//! that was too narrow: the scale becomes as unsure as it has moved, which is the prior under which
//! that was most likely (empirical Bayes), and again at twice the way. A while, since where a
//! vehicle starts and stops single fixes move the scale far and back again.

use super::state::{SCALE, State};
use crate::scalar::Scalar;
use crate::tuning::Tuning;

/// How long it must be beyond that, cells: 500 m.
const PERSISTENCE_CELLS: u32 = 200;

/// How far the scale is from where it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct FarScale {
    /// Where it began.
    prior: f32,
    /// How far it may go.
    limit: f32,
    /// The cell since which it has gone further.
    since_cell: Option<u32>,
    /// Variance that was added to the prior's.
    added: f32,
}

impl FarScale {
    /// Nothing is known.
    pub(super) const fn new() -> Self {
        Self {
            prior: 0.0,
            limit: f32::INFINITY,
            since_cell: None,
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
    pub(super) fn begin<S: Scalar>(&mut self, state: &State<S>, tuning: &Tuning) {
        self.since_cell = None;
        self.prior = state.x[SCALE].to_f32();
        self.limit = tuning.scale_sigmas * state.sigma(SCALE).to_f32();
    }

    /// Widens what a state knows of the scale at the end of a cell, where that has gone too far for
    /// too long. Whether it did.
    pub(super) fn widen<S: Scalar>(&mut self, state: &mut State<S>, cell: u32) -> bool {
        let away = (state.x[SCALE].to_f32() - self.prior).abs();
        if away <= self.limit {
            self.since_cell = None;
            return false;
        }
        let since_cell = *self.since_cell.get_or_insert(cell);
        let is_far = cell.saturating_sub(since_cell) >= PERSISTENCE_CELLS;
        if is_far {
            self.since_cell = None;
            self.limit = 2.0 * away;
            self.added = away * away;
            state.p.add_variance(SCALE, S::from_f32(self.added));
        }
        is_far
    }
}
