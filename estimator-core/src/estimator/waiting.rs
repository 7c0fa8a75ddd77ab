//! Cells that wait for their lagged estimate.

use crate::cell::{Cell, CellEnd};
use crate::inference::window::{Slope, SmoothedCell, WAITING_CELLS};
use heapless::Deque;

/// Cells that may wait: those of the lag, and the newest one.
const CAPACITY: usize = WAITING_CELLS + 1;

/// A cell whose lag is not over, or that was not fetched yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct WaitingCell {
    pub end: CellEnd,
    /// Live slope at its end.
    pub live: Slope,
    pub live_consistent: bool,
    /// Whether its signals agree, as far as the sampler knows.
    pub signals_agree: bool,
}

impl WaitingCell {
    /// Returns the cell with its smoothed slope, whose variance the age of the signals widens.
    pub(super) fn smoothed(
        &self,
        smoothed: &SmoothedCell,
        timing_variance: f32,
        origin_m: Option<f32>,
    ) -> Cell {
        let altitude = |origin_m| smoothed.altitude.uncertain().plus(origin_m);
        Cell {
            lagged_grade_percent: smoothed.slope.widened(timing_variance).grade(),
            altitude_m: origin_m.map(altitude),
            lagged_consistent: self.signals_agree && smoothed.disagreement.is_none(),
            ..self.unsmoothed()
        }
    }

    /// Returns the cell without any later measurement.
    pub(super) fn unsmoothed(&self) -> Cell {
        Cell {
            end: self.end,
            live_grade_percent: self.live.grade(),
            lagged_grade_percent: self.live.grade(),
            altitude_m: None,
            live_consistent: self.live_consistent,
            lagged_consistent: self.live_consistent,
        }
    }
}

/// The cells that wait, the oldest first.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    cells: Deque<WaitingCell, CAPACITY>,
    /// Number of the first ones that no later measurement smooths.
    given_up: usize,
}

impl Waiting {
    #[inline(always)] // See Estimator::new_in().
    pub(super) const fn new() -> Self {
        Self {
            cells: Deque::new(),
            given_up: 0,
        }
    }

    /// Adds the newest cell. Returns whether the oldest one is lost for it.
    pub(super) fn push(&mut self, cell: WaitingCell) -> bool {
        let is_full = self.cells.is_full();
        if is_full {
            self.pop();
        }
        // There is room.
        let _ = self.cells.push_back(cell);
        is_full
    }

    /// Marks the newest cells: their signals disagree, as is known since.
    pub(super) fn mark(&mut self, count: usize) {
        for cell in self.cells.iter_mut().rev().take(count) {
            cell.signals_agree = false;
        }
    }

    /// Gives up smoothing the cells that wait.
    pub(super) fn give_up(&mut self) {
        self.given_up = self.cells.len();
    }

    /// Returns whether the oldest cell is not smoothed any more.
    pub(super) const fn has_given_up(&self) -> bool {
        self.given_up > 0
    }

    /// Takes the oldest cell.
    pub(super) fn pop(&mut self) -> Option<WaitingCell> {
        self.given_up = self.given_up.saturating_sub(1);
        self.cells.pop_front()
    }
}
