//! Where the force is in doubt: it is then a state of its own, which ends where the doubt ends.

use super::variances::{CellVariances, DoubtCell};
use crate::filter::CellInput;
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Cells between two steps of the doubtful force, 20 m.
const STEP_CELLS: u8 = 8;

/// Goes along the cells and finds where the force is in doubt.
#[derive(Clone, Copy, Debug)]
pub struct DoubtFinder {
    /// Whether overrun may hide a brake that no signal reports.
    pub overrun_is_doubtful: bool,
    was_on: bool,
    rested: bool,
    overran: bool,
    since_step: u8,
}

impl DoubtFinder {
    /// Starts before the first cell.
    #[must_use]
    pub const fn new(overrun_is_doubtful: bool) -> Self {
        Self {
            overrun_is_doubtful,
            was_on: false,
            rested: false,
            overran: false,
            since_step: 0,
        }
    }

    /// Finds how the force of the next cell is in doubt, and opens or closes its step.
    pub fn next(&mut self, numbers: &Numbers, cell: &CellInput, variances: &mut CellVariances) {
        let rests = cell.rest_percent > numbers.least_force_percent;
        let overruns = self.overrun_is_doubtful && cell.marks.overrun;
        let retards = cell.retards(numbers);
        let is_on = rests || overruns || retards;
        if !is_on && !self.was_on {
            // Nearly every cell.
            (variances.doubt, variances.doubt_cell) = (0.0, DoubtCell::NONE);
            return;
        }
        let renews = rests && self.rested && cell.marks.rest_begins && !overruns;
        let begins =
            !self.was_on || renews || (rests && !self.rested) || (overruns && !self.overran);
        if begins {
            self.since_step = 0;
        }
        // The offset of an accelerometer lasts as long as it stands in.
        let lasts = cell.marks.by_accelerometer && !begins;
        let steps = is_on && !lasts && self.since_step.is_multiple_of(STEP_CELLS);
        self.since_step = (self.since_step + 1) % STEP_CELLS;
        let of = |applies: bool, percent: f32| if applies { percent * percent } else { 0.0 };
        let scale = of(overruns, numbers.overrun_doubt_percent)
            + of(rests, numbers.rest_doubt * cell.rest_percent)
            + of(retards, numbers.retarder_noise * cell.retarder_percent);
        let step_percent = if steps { Scalar::sqrt(scale) } else { 0.0 };
        if steps != (variances.doubt > 0.0) {
            // A retarder nearly always has the force that it reports, a fault is rare and large.
            let is_fault = rests || overruns;
            let start_percent = if is_fault {
                numbers.start_doubt_percent
            } else {
                step_percent
            };
            variances.doubt = of(steps, start_percent);
        }
        variances.doubt_cell = DoubtCell {
            is_on,
            renews,
            step_percent,
        };
        (self.was_on, self.rested, self.overran) = (is_on, rests, overruns);
    }
}
