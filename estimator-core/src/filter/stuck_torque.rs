//! A torque that is stuck: altitudes leave the climb of the forces while it does not change.
//!
//! A torque that rests is no fault: on an even slope it does for minutes at a resolution of 1 %. But
//! where the climb of the forces goes wrong with a torque that has rested since before, the torque is
//! more likely wrong than the receiver. It does not count again until it changes.

use crate::cell::CELL_LENGTH_M;
use crate::sample::Sample;
use crate::tuning::Gates;

/// How long the torque rests, and whether it is found to be stuck.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StuckTorque {
    resting_cells: u32,
    is_found: bool,
}

impl StuckTorque {
    /// Advances over a cell. Returns whether its torque is stuck.
    #[inline]
    pub(super) fn advance(&mut self, sample: &Sample) -> bool {
        if !sample.torque_rests || sample.gap_cells > 0 {
            *self = Self::default();
            return false;
        }
        self.resting_cells = self.resting_cells.saturating_add(1);
        self.is_found && sample.effect_inputs.engaged
    }

    /// Returns the number of cells, up to that of the sample, over which the torque rests; none if the
    /// driveline is open there: the torque is then not what is off.
    pub(super) const fn resting_cells(&self, sample: &Sample) -> u32 {
        if sample.effect_inputs.engaged {
            self.resting_cells
        } else {
            0
        }
    }

    /// Notes that the torque is stuck.
    pub(super) const fn found(&mut self) {
        self.is_found = true;
    }

    /// Returns whether a torque that has rested for `resting_cells` has done so over most of the last
    /// `cells`: all but a segment of the climb test, in which it came to rest.
    pub(super) fn covers(resting_cells: u32, cells: u32, tuning: &Gates) -> bool {
        resting_cells > cells / 2
            && resting_cells as f32 + tuning.drift_segment_m / CELL_LENGTH_M >= cells as f32
    }
}
