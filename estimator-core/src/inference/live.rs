//! The live estimate: the window takes a cell, and moves its newest state over it.

use super::doubt::DoubtFinder;
use super::levels::{LevelSums, Levels};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use super::window::{
    LiveSlope, Slope, UPDATE_CELLS, Window, is_undecided, of_doubtful_force, timing_variance,
};
use crate::cell::{CELL_LENGTH_M, Disagreement};
use crate::filter::{CellInput, DoubtBehind, Quantity, Record, State};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Slope beyond which a number has been lost, %.
const LARGEST_PERCENT: f32 = 1e3;

impl<S: Scalar> Window<S> {
    /// Takes a cell, and the rest of the torque that ended in it. `prior` makes the state before the
    /// first cell. The window must not be [busy](Self::is_busy).
    pub fn push(
        &mut self,
        numbers: &Numbers,
        cell: &CellInput,
        doubt_behind: Option<&DoubtBehind>,
        prior: impl FnOnce() -> State<S>,
    ) -> LiveSlope {
        if !self.has_begun {
            self.has_begun = true;
            self.newest = prior();
            self.adopted.committed = self.newest;
        }
        self.make_room();
        let index = self.cells.len();
        if index.is_multiple_of(SEGMENT_CELLS) {
            let mut segment = SegmentVariances::start(numbers, numbers.live_multiplier);
            // A road that was smooth so far may bend here.
            segment.road *= Scalar::max(1.0, 1.0 / self.adopted.levels.road);
            let _ = self.adopted.segments.push(segment);
        }
        let mut own = CellVariances::START;
        self.newest_doubt.next(numbers, cell, &mut own);
        // There is room: an update makes it.
        let _ = self.cells.push(*cell);
        let _ = self.adopted.own.push(own);
        if let Some(doubt) = doubt_behind {
            doubt.mark(&mut self.cells);
        }
        let live = self.step_live(numbers, cell, index);
        if self.cells.len().is_multiple_of(UPDATE_CELLS) {
            if self.infers {
                self.begin_update(numbers, false);
            } else {
                self.leave_all();
            }
        }
        live
    }

    /// Adds to the memory of the rounds, one element of each a cell: all at once would be the longest
    /// call. The first update comes when it is complete.
    fn make_room(&mut self) {
        if !self.records.is_full() {
            let _ = self.records.push(Record::EMPTY);
        }
        if !self.checkpoints.is_full() {
            let _ = self.checkpoints.push(State::ZERO);
        }
    }

    fn step_live(&mut self, numbers: &Numbers, cell: &CellInput, index: usize) -> LiveSlope {
        let round = self.adopted.round(numbers, 0);
        let stretch = self.adopted.stretch(&self.cells, 0);
        let Some((_, terms)) = round.terms(&stretch, index) else {
            return self.restart(numbers);
        };
        let gate = S::from_f32(numbers.gate);
        let mut record = Record::EMPTY;
        round.step(&mut self.newest, cell, &terms, Some(gate), &mut record);
        let (slope, _) = self.newest.quantity(Quantity::RoadSlope);
        let slope = slope.to_single();
        let before = core::mem::replace(&mut self.live_slope, slope.mean);
        let rate = (slope.mean - before) / CELL_LENGTH_M;
        let timing = timing_variance(numbers, cell.speed_mps, rate);
        let variance = slope.variance + self.undecided_variance + timing;
        let is_sound = self.newest.is_sound()
            && slope.mean.abs() < LARGEST_PERCENT
            && slope.variance >= 0.0
            && variance.is_finite();
        if !is_sound {
            return self.restart(numbers);
        }
        let (force, _) = self.newest.quantity(Quantity::DoubtfulForce);
        LiveSlope {
            slope: Slope {
                mean: slope.mean,
                variance,
            },
            disagreement: Disagreement {
                climb: is_undecided(numbers, self.undecided_variance),
                ..of_doubtful_force(numbers, cell, force.mean.to_f32())
            },
            used_altitude: record.altitude.map(|update| update.used().is_some()),
            used_slope: record.slope.map(|update| update.used().is_some()),
            speed_steps: record.speed_steps,
            restarted: false,
        }
    }

    /// Forgets everything but the hypothesis: a number is not finite. The cells of the window are lost.
    fn restart(&mut self, numbers: &Numbers) -> LiveSlope {
        let hypothesis = self.hides_brakes();
        for doubt in [&mut self.adopted.doubt, &mut self.newest_doubt] {
            *doubt = DoubtFinder::new(hypothesis);
        }
        self.clear();
        (self.fetched, self.finished) = (0, 0);
        (self.adopted.levels, self.adopted.past) = (Levels::ONE, LevelSums::NONE);
        (self.undecided_variance, self.live_slope) = (0.0, 0.0);
        self.has_begun = false;
        let prior = numbers.prior_slope_percent;
        LiveSlope {
            slope: Slope {
                mean: 0.0,
                variance: prior * prior,
            },
            disagreement: Disagreement {
                climb: true,
                ..Disagreement::NONE
            },
            used_altitude: None,
            used_slope: None,
            speed_steps: false,
            restarted: true,
        }
    }
}
