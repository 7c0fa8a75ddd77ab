//! The trial of the hypothesis that brakes act which no signal reports: overrun may hide them.
//!
//! It runs beside the rounds of the window while overrun is in it, on a state and variances of its own.
//! The force that it finds behind the lag decides. Likelihoods do not tell the hypotheses apart: a
//! constant retarder is cheap as a step of the bias.

use super::round::{Memory, Pass, Round, Stretch};
use super::variances::{CellVariances, SegmentVariances};
use super::window::{BLOCK_CELLS, LAG_CELLS, SHARE_CELLS, UPDATE_CELLS, Window};
use super::work::Work;
use crate::cell::CELL_LENGTH_M;
use crate::filter::{Adjoint, CellInput, Quantity, Record};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Rounds of the trial in an update.
const ROUNDS: u8 = 2;
/// Force beyond which a brake is hidden, %, at a distance of four sigmas.
const HIDDEN_BRAKE_PERCENT: f32 = 1.0;
/// Distance over which brakes must have been hidden for the bus to count as one without them, m.
const HIDDEN_BRAKE_M: f32 = 20.0;

fn overruns(cell: &CellInput) -> bool {
    cell.marks.overrun && !cell.marks.invalid
}

impl<S: Scalar> Window<S> {
    /// Goes on with the trial if overrun is in the window, and then lets the first cells leave.
    pub(super) fn begin_trial_or_leave(&mut self, numbers: &Numbers, leaving: usize) {
        if self.hides_brakes() || !self.cells.iter().any(overruns) {
            self.trial.end();
            self.begin_leave(leaving);
            return;
        }
        if !self.trial.is_on {
            self.trial.is_on = true;
            self.trial.committed = self.committed;
            (self.trial.levels, self.trial.past) = (self.levels, self.past);
            self.trial.doubt = self.doubt;
            self.trial.doubt.overrun_is_doubtful = true;
        }
        // There is room, as in the window.
        let _ = self
            .trial
            .own
            .resize(self.cells.len(), CellVariances::START);
        let start = SegmentVariances::start(numbers, 1.0);
        let _ = self.trial.segments.resize(self.segments.len(), start);
        self.work = Work::Trial {
            left: ROUNDS,
            leaving,
        };
        self.begin_trial_round(numbers, leaving);
    }

    fn begin_trial_round(&mut self, numbers: &Numbers, leaving: usize) {
        let trial = &mut self.trial;
        let mut doubt = trial.doubt;
        for (index, (cell, own)) in self.cells.iter().zip(&mut trial.own).enumerate() {
            if index == leaving {
                trial.doubt_behind_leaving = doubt;
            }
            doubt.next(numbers, cell, own);
        }
        self.pass = Pass::from(trial.committed);
    }

    /// Does a share of the trial. What it finds behind the lag counts.
    pub(super) fn try_hypothesis(&mut self, numbers: &Numbers, left: u8, leaving: usize) {
        let leaves = if left == 1 { leaving } else { 0 };
        let round = Round {
            levels: self.trial.levels,
            ..self.round(numbers, leaves)
        };
        let (cells, count) = (&self.cells, self.cells.len());
        let behind_lag =
            count.saturating_sub(LAG_CELLS + UPDATE_CELLS)..count.saturating_sub(LAG_CELLS);
        let trial = &mut self.trial;
        let mut stretch = Stretch {
            cells,
            own: &mut trial.own,
            segments: &mut trial.segments,
        };
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        let hidden = &mut trial.hidden_cells;
        let take = |index: usize, record: &Record<S>, adjoint: &Adjoint<S>| {
            let counts =
                left == 1 && behind_lag.contains(&index) && cells.get(index).is_some_and(overruns);
            if counts {
                let force = adjoint.smooth(&record.state, Quantity::DoubtfulForce);
                let force = force.to_single();
                let least = force.mean - 4.0 * Scalar::sqrt(force.variance);
                *hidden += usize::from(least > HIDDEN_BRAKE_PERCENT);
            }
        };
        self.pass
            .advance(&round, &mut stretch, &mut memory, SHARE_CELLS, take);
        if !self.pass.is_done() {
            return;
        }
        let trial = &mut self.trial;
        self.pass.found.revive(numbers, &mut trial.segments);
        let left_m = leaves as f32 * CELL_LENGTH_M;
        let kept = libm::expf(-left_m / numbers.level_memory_m);
        trial.past = trial.past.decayed_plus(kept, &self.pass.leaving);
        let sums = trial.past.decayed_plus(1.0, &self.pass.found.sums);
        trial.levels = sums.levels(numbers);
        if left > 1 {
            self.work = Work::Trial {
                left: left - 1,
                leaving,
            };
            self.begin_trial_round(numbers, leaving);
        } else {
            self.end_trial(leaving);
        }
    }

    /// Decides, at the end of the rounds of an update.
    fn end_trial(&mut self, leaving: usize) {
        let trial = &mut self.trial;
        if trial.hidden_cells as f32 * CELL_LENGTH_M > HIDDEN_BRAKE_M {
            core::mem::swap(&mut self.own, &mut trial.own);
            core::mem::swap(&mut self.segments, &mut trial.segments);
            self.committed = trial.committed;
            (self.levels, self.past) = (trial.levels, trial.past);
            (self.doubt, self.doubt_behind_leaving) = (trial.doubt, trial.doubt_behind_leaving);
            self.newest_doubt.overrun_is_doubtful = true;
            trial.end();
            self.past_steps.clear();
            self.take_newest(self.pass.newest);
        } else if leaving > 0 {
            if let Some(state) = self.checkpoints.get(leaving / BLOCK_CELLS) {
                trial.committed = *state;
            }
            trial.drop_first(leaving);
        }
        self.begin_leave(leaving);
    }
}
