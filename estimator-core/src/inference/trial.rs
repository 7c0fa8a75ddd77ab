//! The trial of the hypothesis that brakes act which no signal reports: overrun may hide them.
//!
//! It runs beside the rounds of the window while overrun is in it, on a state and variances of its own.
//! What it finds behind the lag decides.

use super::hidden_brakes::HiddenBrakes;
use super::round::{Memory, Pass};
use super::variances::{CellVariances, SegmentVariances};
use super::window::{BLOCK_CELLS, LAG_CELLS, SHARE_CELLS, UPDATE_CELLS, Window};
use super::work::Work;
use crate::filter::{Adjoint, Record};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

impl<S: Scalar> Window<S> {
    /// Goes on with the trial if overrun is in the window, and then lets the first cells leave.
    pub(super) fn begin_trial_or_leave(&mut self, numbers: &Numbers) {
        if self.hides_brakes() || !self.cells.iter().any(HiddenBrakes::could_be_in) {
            self.end_trial();
            self.begin_leave();
            return;
        }
        let trial = &mut self.trial;
        if !self.is_trying {
            self.is_trying = true;
            trial.committed = self.adopted.committed;
            (trial.levels, trial.past) = (self.adopted.levels, self.adopted.past);
            trial.doubt = self.adopted.doubt;
            trial.doubt.overrun_is_doubtful = true;
        }
        // There is room, as in the window.
        let _ = trial.own.resize(self.cells.len(), CellVariances::START);
        let start = SegmentVariances::start(numbers, 1.0);
        let _ = trial.segments.resize(self.adopted.segments.len(), start);
        self.work = Work::Trial;
        let leaving = self.leaving();
        self.trial.find_doubt(numbers, &self.cells, leaving);
        self.pass = Pass::from(self.trial.committed);
    }

    /// Does a share of the trial. What it finds behind the lag counts.
    pub(super) fn try_hypothesis(&mut self, numbers: &Numbers) {
        let round = self.trial.round(numbers, self.leaving());
        let (cells, hidden) = (&self.cells, &mut self.hidden_brakes);
        let newest_due = cells.len().saturating_sub(LAG_CELLS);
        let due = newest_due.saturating_sub(UPDATE_CELLS)..newest_due;
        let mut stretch = self.trial.stretch(cells, 0);
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        let take = |index: usize, record: &Record<S>, later: &Adjoint<S>| {
            if let (true, Some(cell)) = (due.contains(&index), cells.get(index)) {
                hidden.take(cell, record, later);
            }
        };
        self.pass
            .advance(&round, &mut stretch, &mut memory, SHARE_CELLS, take);
        if self.pass.is_done() {
            self.work = Work::Decide;
        }
    }

    /// Decides, at the end of an update.
    pub(super) fn decide(&mut self, numbers: &Numbers) {
        let leaving = self.leaving();
        self.trial.end_round(numbers, &self.pass, leaving);
        if self.hidden_brakes.are_found() {
            core::mem::swap(&mut self.adopted, &mut self.trial);
            self.newest_doubt.overrun_is_doubtful = true;
            self.end_trial();
            self.past_steps.clear();
            self.take_newest(self.pass.newest);
            self.keep_recent();
        } else if leaving > 0 {
            if let Some(state) = self.checkpoints.get(leaving / BLOCK_CELLS) {
                self.trial.committed = *state;
            }
            self.trial.drop_first(leaving);
        }
        self.begin_leave();
    }

    pub(super) fn end_trial(&mut self) {
        self.is_trying = false;
        self.trial.clear();
    }
}
