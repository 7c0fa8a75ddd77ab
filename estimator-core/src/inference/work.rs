//! What an update of the window is at.

use super::doubt::DoubtFinder;
use super::levels::{LevelSums, Levels};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use crate::filter::State;
use crate::scalar::Scalar;
use heapless::Vec;

/// What the window is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing: it waits for cells.
    None,
    /// Rounds, this many left. `ends` is whether the drive does.
    Rounds { left: u8, ends: bool },
    /// Rounds of the trial, this many left, before so many cells leave.
    Trial { left: u8, leaving: usize },
    /// The cells that leave, from this one on: the state before the window goes over them.
    Leave { at: usize },
}

/// The window under the hypothesis.
#[derive(Clone, Debug)]
pub(super) struct Trial<S, const CELLS: usize, const SEGMENTS: usize> {
    pub is_on: bool,
    pub own: Vec<CellVariances, CELLS>,
    pub segments: Vec<SegmentVariances, SEGMENTS>,
    pub doubt: DoubtFinder,
    pub doubt_behind_leaving: DoubtFinder,
    pub committed: State<S>,
    pub levels: Levels,
    /// Sums behind the levels of the cells before the window.
    pub past: LevelSums,
    /// Cells in which brakes acted that no signal reported.
    pub hidden_cells: usize,
}

impl<S: Scalar, const CELLS: usize, const SEGMENTS: usize> Trial<S, CELLS, SEGMENTS> {
    #[inline(always)] // See Estimator::new_in().
    pub(super) const fn new() -> Self {
        Self {
            is_on: false,
            own: Vec::new(),
            segments: Vec::new(),
            doubt: DoubtFinder::new(true),
            doubt_behind_leaving: DoubtFinder::new(true),
            committed: State::ZERO,
            levels: Levels::ONE,
            past: LevelSums::NONE,
            hidden_cells: 0,
        }
    }

    pub(super) fn end(&mut self) {
        self.is_on = false;
        self.own.clear();
        self.segments.clear();
    }

    pub(super) fn drop_first(&mut self, leaving: usize) {
        self.doubt = self.doubt_behind_leaving;
        drop_first(&mut self.own, leaving);
        drop_first(&mut self.segments, leaving / SEGMENT_CELLS);
    }
}

/// Drops the first elements of a list.
pub(super) fn drop_first<T: Copy, const N: usize>(list: &mut Vec<T, N>, count: usize) {
    let left = list.len().saturating_sub(count);
    for at in 0..left {
        if let Some(later) = list.get(at + count).copied()
            && let Some(place) = list.get_mut(at)
        {
            *place = later;
        }
    }
    list.truncate(left);
}
