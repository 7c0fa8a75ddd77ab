//! Reset of the scale's prior: for a vehicle that is far from its parameters.
//!
//! A file written for a full truck that drives empty is wrong by many sigmas of the scale's prior. A
//! filter that trusts such a prior takes its sensors for noisy and settles between the two. Where
//! the scale has been off by more than [`scale_reset_sigmas`] for a while, the prior was too narrow.
//! The variance of the scale then grows by the square of the distance that it has moved, which makes
//! that distance most likely (empirical Bayes). It grows again at twice the distance. The reset
//! waits for a while, since at launches and stops single fixes move the scale far and back again.
//!
//! [`scale_reset_sigmas`]: crate::tuning::Prior::scale_reset_sigmas

use super::state::State;
use super::state_index::StateIndex;
use crate::scalar::Scalar;
use crate::tuning::Prior;

/// Distance of the scale from the prior of any load, in sigmas, beyond which that prior was too narrow.
const OPEN_SIGMAS: f32 = 1.5;

/// Distance of the scale from its prior.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScalePriorReset {
    /// Mean of the prior.
    prior: f32,
    /// Largest distance from it that is believed.
    limit: f32,
    /// Cell since which the distance is larger.
    since_cell: Option<u32>,
    /// Variance that was added to the prior's.
    added: f32,
}

impl ScalePriorReset {
    /// Creates the test before a prior is known.
    pub(super) const fn new() -> Self {
        Self {
            prior: 0.0,
            limit: f32::INFINITY,
            since_cell: None,
            added: 0.0,
        }
    }

    /// Returns the variance that the prior lacked.
    pub(super) const fn added(&self) -> f32 {
        self.added
    }

    /// Returns the test before its start, with that variance as part of the prior.
    pub(super) const fn restarted(&self) -> Self {
        Self {
            added: self.added,
            ..Self::new()
        }
    }

    /// Starts with what a state holds as the prior of the scale.
    pub(super) fn start<S: Scalar>(&mut self, state: &State<S>, tuning: &Prior) {
        self.start_within(tuning.scale_reset_sigmas, state);
    }

    /// Starts at the first cell of a drive of which no message reports the mass.
    pub(super) fn start_open<S: Scalar>(&mut self, state: &State<S>) {
        self.start_within(OPEN_SIGMAS, state);
    }

    #[inline(never)] // Rare, and called from several places.
    fn start_within<S: Scalar>(&mut self, sigmas: f32, state: &State<S>) {
        self.since_cell = None;
        self.prior = state.mean[StateIndex::Scale].to_f32();
        self.limit = sigmas * state.sigma(StateIndex::Scale).to_f32();
    }

    /// Widens the covariance of the scale at the end of a cell, if the scale has been too far from
    /// its prior for long enough. Returns whether it did.
    pub(super) fn widen<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        cell: u32,
        tuning: &Prior,
    ) -> bool {
        let distance = (state.mean[StateIndex::Scale].to_f32() - self.prior).abs();
        if distance <= self.limit {
            self.since_cell = None;
            return false;
        }
        let since_cell = *self.since_cell.get_or_insert(cell);
        let is_far = cell.saturating_sub(since_cell) >= tuning.scale_reset_cells;
        if is_far {
            self.since_cell = None;
            self.limit = 2.0 * distance;
            self.added = distance * distance;
            let added = S::from_f32(self.added);
            state.covariance.add_variance(StateIndex::Scale, added);
        }
        is_far
    }
}
