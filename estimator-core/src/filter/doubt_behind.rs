//! What a cell says of those before it: where a torque that rested jumps, or an accelerometer
//! contradicts the force, the force was in doubt for some time.

use super::cell_input::CellInput;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;

/// Doubt of the force over the cells that end with the newest one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubtBehind {
    /// Duration of the cells, s.
    pub duration_s: f32,
    /// Sigma of the force meanwhile, as a slope, %.
    pub percent: f32,
}

impl DoubtBehind {
    /// Returns that of a rest of the torque that ended in the cell of a sample; `None` if none did, or if
    /// the torque rested at a limit, where it was known.
    #[must_use]
    pub fn of_rest(tuning: &Tuning, sample: &Sample) -> Option<Self> {
        let rest = &sample.torque_rest;
        if rest.ended_s <= 0.0 || rest.ended_at_limit {
            return None;
        }
        let walk_n = walk_n(tuning, rest.ended_s, rest.per_percent_n);
        let sigma_n = Scalar::sqrt(rest.jump_n.squared() + walk_n.squared());
        Some(Self {
            duration_s: rest.ended_s,
            percent: 100.0 * sigma_n / sample.forces.weight_n(),
        })
    }

    /// Marks the cells, of which the newest one is the last.
    pub fn mark(&self, cells: &mut [CellInput]) {
        let mut left_s = self.duration_s;
        for cell in cells.iter_mut().rev() {
            cell.rest_percent = Scalar::max(cell.rest_percent, self.percent);
            left_s -= cell.duration_s;
            if left_s < 0.0 {
                cell.marks.rest_begins = true;
                return;
            }
        }
    }
}

/// Returns by how much a torque may be off that is not renewed, N.
pub(super) fn walk_n(tuning: &Tuning, rest_s: f32, per_percent_n: f32) -> f32 {
    if rest_s > tuning.hold_times.reading_timeout.seconds() {
        tuning.estimation.rest_walk_percent * Scalar::sqrt(rest_s) * per_percent_n
    } else {
        0.0
    }
}
