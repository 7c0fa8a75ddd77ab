//! What the window infers under one hypothesis about brakes without a signal.

use super::cell_model::CellModel;
use super::doubt::DoubtFinder;
use super::levels::{LevelSums, Levels};
use super::round::{Pass, Round, Stretch};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use super::work::drop_first;
use crate::cell::CELL_LENGTH_M;
use crate::filter::{CellInput, State};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use heapless::Vec;

/// Variances and levels of the window, and the state before it.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis<S, const CELLS: usize, const SEGMENTS: usize> {
    pub own: Vec<CellVariances, CELLS>,
    pub segments: Vec<SegmentVariances, SEGMENTS>,
    /// How the force was in doubt before the window.
    pub doubt: DoubtFinder,
    pub doubt_behind_leaving: DoubtFinder,
    /// The state before the window.
    pub committed: State<S>,
    pub levels: Levels,
    /// Sums behind the levels of the cells before the window.
    pub past: LevelSums,
}

impl<S: Scalar, const CELLS: usize, const SEGMENTS: usize> Hypothesis<S, CELLS, SEGMENTS> {
    #[inline(always)] // See Estimator::new_in().
    pub(super) const fn new(overrun_is_doubtful: bool) -> Self {
        Self {
            own: Vec::new(),
            segments: Vec::new(),
            doubt: DoubtFinder::new(overrun_is_doubtful),
            doubt_behind_leaving: DoubtFinder::new(overrun_is_doubtful),
            committed: State::ZERO,
            levels: Levels::ONE,
            past: LevelSums::NONE,
        }
    }

    pub(super) fn clear(&mut self) {
        self.own.clear();
        self.segments.clear();
    }

    pub(super) fn round<'n>(&self, numbers: &'n Numbers, leaving: usize) -> Round<'n> {
        Round {
            model: CellModel::new(numbers),
            levels: self.levels,
            infers: true,
            leaving,
        }
    }

    /// Returns the cells with their variances, from the first one of a segment on.
    pub(super) fn stretch<'a>(&'a mut self, cells: &'a [CellInput], from: usize) -> Stretch<'a> {
        Stretch {
            cells: cells.get(from..).unwrap_or_default(),
            own: self.own.get_mut(from..).unwrap_or_default(),
            segments: self
                .segments
                .get_mut(from / SEGMENT_CELLS..)
                .unwrap_or_default(),
        }
    }

    /// Finds anew where the force is in doubt: rests of the torque were marked since the last update.
    /// Returns the finder behind the newest cell.
    pub(super) fn find_doubt(
        &mut self,
        numbers: &Numbers,
        cells: &[CellInput],
        leaving: usize,
    ) -> DoubtFinder {
        let mut doubt = self.doubt;
        for (index, (cell, own)) in cells.iter().zip(&mut self.own).enumerate() {
            if index == leaving {
                self.doubt_behind_leaving = doubt;
            }
            doubt.next(numbers, cell, own);
        }
        doubt
    }

    /// Takes what a round has found. The sums of the cells that leave become past.
    pub(super) fn end_round(&mut self, numbers: &Numbers, pass: &Pass<S>, leaving: usize) {
        pass.found.revive(numbers, &mut self.segments);
        let left_m = leaving as f32 * CELL_LENGTH_M;
        let kept = libm::expf(-left_m / numbers.level_memory_m);
        self.past = self.past.decayed_plus(kept, &pass.leaving);
        let sums = self.past.decayed_plus(1.0, &pass.found.sums);
        self.levels = sums.levels(numbers);
    }

    /// Drops the variances of the first cells: whole segments.
    pub(super) fn drop_first(&mut self, leaving: usize) {
        self.doubt = self.doubt_behind_leaving;
        drop_first(&mut self.own, leaving);
        drop_first(&mut self.segments, leaving / SEGMENT_CELLS);
    }
}
