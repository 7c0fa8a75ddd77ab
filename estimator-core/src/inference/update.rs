//! The update of the window, in shares of work: a round over its newest cells, whose variances are far
//! from settled; one over all cells, which gives the lagged estimates; then the trial of hidden brakes,
//! and the cells that leave.

use super::round::{Memory, Pass, Stretch};
use super::variances::SEGMENT_CELLS;
use super::window::{
    BLOCK_CELLS, LAG_CELLS, SHARE_CELLS, SmoothedCell, UPDATE_CELLS, WINDOW_CELLS, Window,
    is_undecided, of_doubtful_force,
};
use super::work::{Work, drop_first};
use crate::filter::{Adjoint, CellInput, Quantity, Record};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Cells before those of an update that the round over the newest cells takes again.
const AGAIN_CELLS: usize = UPDATE_CELLS;

impl<S: Scalar> Window<S> {
    /// Returns whether a share of work is left to do.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.work != Work::None
    }

    /// Begins the last update of a drive, after which all cells are finished. Returns false if none is
    /// left.
    pub fn begin_end(&mut self, numbers: &Numbers) -> bool {
        if self.cells.is_empty() || !self.infers {
            return false;
        }
        self.begin_update(numbers, true);
        true
    }

    pub(super) fn begin_update(&mut self, numbers: &Numbers, ends: bool) {
        self.work = Work::Newest { ends };
        let leaving = self.leaving();
        self.newest_doubt = self.adopted.find_doubt(numbers, &self.cells, leaving);
        self.pass = Pass::from(if self.recent_from == 0 {
            self.adopted.committed
        } else {
            self.recent
        });
    }

    /// Returns the number of cells that leave with an update: whole updates.
    pub(super) fn leaving(&self) -> usize {
        self.cells.len().saturating_sub(WINDOW_CELLS) / UPDATE_CELLS * UPDATE_CELLS
    }

    /// Does a share of the work.
    pub fn work(&mut self, numbers: &Numbers) {
        match self.work {
            Work::None => {}
            Work::Newest { ends } => self.infer_newest(numbers, ends),
            Work::All { ends } => self.infer_all(numbers, ends),
            Work::Take { ends } => self.end_round(numbers, ends),
            Work::Finish { ends } => self.finish(numbers, ends),
            Work::Trial => self.try_hypothesis(numbers),
            Work::Decide => self.decide(numbers),
            Work::Leave { at } => self.leave(numbers, at),
            Work::Drop => self.drop_first(UPDATE_CELLS),
        }
    }

    fn infer_newest(&mut self, numbers: &Numbers, ends: bool) {
        let round = self.adopted.round(numbers, 0);
        let from = self.recent_from;
        let mut stretch = self.adopted.stretch(&self.cells, from);
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        self.pass
            .advance(&round, &mut stretch, &mut memory, SHARE_CELLS, |_, _, _| ());
        if self.pass.is_done() {
            self.pass.found.revive(numbers, stretch.segments);
            self.work = Work::All { ends };
            self.pass = Pass::from(self.adopted.committed);
        }
    }

    fn infer_all(&mut self, numbers: &Numbers, ends: bool) {
        let round = self.adopted.round(numbers, self.leaving());
        let first = self.given.saturating_sub(1);
        let (cells, smoothed) = (&self.cells, &mut self.smoothed);
        let mut stretch = self.adopted.stretch(cells, 0);
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        let take = |index: usize, record: &Record<S>, adjoint: &Adjoint<S>| {
            let place = index.checked_sub(first).and_then(|at| smoothed.get_mut(at));
            if let (Some(place), Some(cell)) = (place, cells.get(index)) {
                *place = smooth(numbers, cell, record, adjoint);
            }
        };
        self.pass
            .advance(&round, &mut stretch, &mut memory, SHARE_CELLS, take);
        if self.pass.is_done() {
            self.work = Work::Take { ends };
        }
    }

    /// Keeps the state from which the next round over the newest cells begins.
    pub(super) fn keep_recent(&mut self) {
        let from = self.cells.len().saturating_sub(AGAIN_CELLS) / BLOCK_CELLS;
        if let Some(state) = self.checkpoints.get(from) {
            (self.recent, self.recent_from) = (*state, from * BLOCK_CELLS);
        }
    }

    /// Takes what a round has found.
    fn end_round(&mut self, numbers: &Numbers, ends: bool) {
        self.work = Work::Finish { ends };
        let (adjoint, found) = (*self.pass.adjoint(), &mut self.pass.found);
        let past = self.past_steps.judge(numbers, &adjoint, found);
        if let Some(at) = past {
            self.past_steps.open(at, &mut self.adopted.committed);
        }
        self.undecided_variance = found.undecided_variance(numbers);
        let leaving = self.leaving();
        self.adopted.end_round(numbers, &self.pass, leaving);
    }

    /// Takes the newest state, and finishes the cells whose lag is over.
    fn finish(&mut self, numbers: &Numbers, ends: bool) {
        self.take_newest(self.pass.newest);
        self.keep_recent();
        let count = self.cells.len();
        let first = self.given.saturating_sub(1);
        let due = if ends {
            count
        } else {
            count.saturating_sub(LAG_CELLS).max(self.given)
        };
        let undecided_from = self.pass.found.likeliest.segment * SEGMENT_CELLS;
        let undecided = self.undecided_variance;
        let most = numbers.inconsistent_percent * numbers.inconsistent_percent;
        for index in self.given..due {
            let Some(cell) = self.smoothed.get_mut(index - first) else {
                break;
            };
            let shock = self
                .adopted
                .segments
                .get(index / SEGMENT_CELLS)
                .is_some_and(|segment| segment.bias_shock > most);
            cell.disagreement.climb = shock;
            if index >= undecided_from {
                cell.slope.variance += undecided;
                cell.disagreement.climb |= is_undecided(numbers, undecided);
            }
        }
        (self.fetched, self.finished) = (self.given - first, due - first);
        self.given = due;
        if ends {
            self.leave_all();
        } else {
            self.begin_trial_or_leave(numbers);
        }
    }

    pub(super) fn begin_leave(&mut self) {
        self.work = if self.leaving() > 0 {
            Work::Leave { at: 0 }
        } else {
            Work::None
        };
    }

    /// Takes the state before the window over a cell that leaves it, with the steps behind it. The many
    /// candidates cost more than a share of a round.
    #[inline(never)] // Its record takes room on the stack, which the rounds need not have beside it.
    fn leave(&mut self, numbers: &Numbers, at: usize) {
        let round = self.adopted.round(numbers, 0);
        let stretch = Stretch {
            cells: &self.cells,
            own: &mut self.adopted.own,
            segments: &mut self.adopted.segments,
        };
        let opened = numbers.start_shock_percent * numbers.start_shock_percent;
        let mut record = Record::EMPTY;
        if let Some((cell, terms)) = round.terms(&stretch, at) {
            let committed = &mut self.adopted.committed;
            round.step(committed, cell, &terms, None, &mut record);
            let segment = stretch.segments.get(at / SEGMENT_CELLS);
            let is_closed = segment.is_some_and(|segment| segment.bias_shock < opened);
            let begins = at.is_multiple_of(SEGMENT_CELLS) && is_closed && !cell.marks.gap;
            self.past_steps
                .carry(numbers, cell, &terms.dynamics, &record, begins);
        }
        self.work = if at + 1 < UPDATE_CELLS {
            Work::Leave { at: at + 1 }
        } else {
            Work::Drop
        };
    }

    /// Returns the next cell whose lag is over, and the slope before it. The oldest comes first.
    pub fn next_finished(&mut self) -> Option<(SmoothedCell, f32)> {
        if self.fetched >= self.finished || self.is_busy() {
            return None;
        }
        let before = self.fetched.saturating_sub(1);
        let cell = *self.smoothed.get(self.fetched)?;
        let before = self.smoothed.get(before)?.slope.mean;
        self.fetched += 1;
        Some((cell, before))
    }

    /// Drops the finished cells that were not fetched, and returns their number.
    pub const fn drop_unfetched(&mut self) -> usize {
        let unfetched = self.finished - self.fetched;
        self.fetched = self.finished;
        unfetched
    }

    /// Drops the first cells: whole segments.
    fn drop_first(&mut self, leaving: usize) {
        self.work = Work::None;
        self.given = self.given.saturating_sub(leaving);
        self.recent_from = self.recent_from.saturating_sub(leaving);
        drop_first(&mut self.cells, leaving);
        self.adopted.drop_first(leaving);
    }
}

fn smooth<S: Scalar>(
    numbers: &Numbers,
    cell: &CellInput,
    record: &Record<S>,
    adjoint: &Adjoint<S>,
) -> SmoothedCell {
    let force = adjoint.smooth(&record.state, Quantity::DoubtfulForce);
    SmoothedCell {
        slope: adjoint
            .smooth(&record.state, Quantity::RoadSlope)
            .to_single(),
        altitude: adjoint
            .smooth(&record.state, Quantity::Altitude)
            .to_single(),
        disagreement: of_doubtful_force(numbers, cell, force.mean.to_f32()),
    }
}
