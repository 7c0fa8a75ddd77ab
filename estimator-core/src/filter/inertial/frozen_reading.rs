//! Readings that stay the same to the last digit: the sensor is stuck.

use crate::sample::InertialMeasurement;
use crate::tuning::Inertial;

/// Resolution up to which equal readings show that, m/s²: that of ACCS, and not that of VDC2. The mean
/// of coarse readings may stay the same on a smooth road.
const FINE_MPS2: f32 = 0.05;

/// The last measurement, and cells since it changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrozenReading {
    last_mps2: f32,
    unchanged_cells: u16,
}

impl FrozenReading {
    pub(super) const fn new() -> Self {
        Self {
            last_mps2: f32::NAN,
            unchanged_cells: 0,
        }
    }

    /// Takes the measurement of a cell. Returns whether the readings are stuck.
    pub(super) fn is_frozen(&mut self, measured: &InertialMeasurement, tuning: &Inertial) -> bool {
        let is_same = measured.acceleration_mps2 == self.last_mps2;
        self.last_mps2 = measured.acceleration_mps2;
        self.unchanged_cells = if is_same {
            self.unchanged_cells.saturating_add(1)
        } else {
            0
        };
        self.unchanged_cells >= tuning.frozen_cells && measured.resolution_mps2 <= FINE_MPS2
    }
}
