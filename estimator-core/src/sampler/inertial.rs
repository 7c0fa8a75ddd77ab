//! Readings of the accelerometer become the mean acceleration of each cell.
//!
//! Between two speed readings counts the mean of what was read, as for the force. Where no reading came
//! in between, the last one stands in until it is stale. Cells take the means of their intervals by
//! distance.

use super::accepted_ranges::ACCELERATIONS_MPS2;
use super::latest::TimedValue;
use super::resolution::Resolution;
use crate::cell::CELL_LENGTH_M;
use crate::sample::InertialMeasurement;
use crate::time::{Duration, Instant};

/// Age beyond which a reading says nothing: a brake changes the deceleration within it.
const TIMEOUT: Duration = Duration::from_millis(500);
/// Coarsest steps of any sensor, m/s². VDC2 has 0.1.
const COARSEST_MPS2: f32 = 0.5;

/// The readings since the last speed reading.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Accelerometer {
    last: Option<TimedValue>,
    sum_mps2: f32,
    count: u16,
    /// m/s².
    resolution: Resolution,
}

/// The mean acceleration between two speed readings, and the number of its readings.
#[derive(Clone, Copy, Debug)]
pub(super) struct IntervalAcceleration {
    mean_mps2: f32,
    count: f32,
}

/// The acceleration in the cell that is being driven.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellAcceleration {
    /// Integral over the distance, and the distance where it is known.
    work_per_kg: f32,
    known_m: f32,
    count: f32,
}

impl Accelerometer {
    /// Takes a reading. One that is not available, or beyond what vehicles reach, changes nothing.
    #[inline(never)] // See Sampler::record().
    pub(super) fn record(&mut self, now: Instant, value: Option<f32>) {
        let Some(value) = value.filter(|mps2| ACCELERATIONS_MPS2.contains(mps2)) else {
            return;
        };
        if let Some(last) = self.last.filter(|last| last.value != value) {
            self.resolution.note(value - last.value);
        }
        self.last = Some(TimedValue { value, time: now });
        if self.count < u16::MAX {
            self.sum_mps2 += value;
            self.count += 1;
        }
    }

    /// Takes a change of the source: its steps are others.
    pub(super) fn switch_source(&mut self) {
        *self = Self::default();
    }

    /// Returns the mean since the last call; `None` if the newest reading is stale.
    #[inline]
    pub(super) fn take(&mut self, now: Instant) -> Option<IntervalAcceleration> {
        let last = self.last?;
        self.mean(now, last)
    }

    #[inline(never)] // Not for the vehicles without the sensor.
    fn mean(&mut self, now: Instant, last: TimedValue) -> Option<IntervalAcceleration> {
        let count = f32::from(core::mem::take(&mut self.count));
        let sum_mps2 = core::mem::take(&mut self.sum_mps2);
        let mean_mps2 = if count > 0.0 {
            sum_mps2 / count
        } else {
            last.value
        };
        (now.since(last.time) <= TIMEOUT).then_some(IntervalAcceleration { mean_mps2, count })
    }

    /// Returns the measurement of a cell; `None` where less than half of it is known.
    #[inline]
    pub(super) fn measurement(&self, cell: &CellAcceleration) -> Option<InertialMeasurement> {
        (cell.known_m >= 0.5 * CELL_LENGTH_M).then(|| InertialMeasurement {
            acceleration_mps2: cell.work_per_kg / cell.known_m,
            // A reading that several cells share counts in each.
            count: (cell.count + 0.5).clamp(1.0, 255.0) as u8,
            resolution_mps2: self.resolution.within(COARSEST_MPS2),
        })
    }
}

impl CellAcceleration {
    /// Adds a piece of an interval, and its part of the interval.
    #[inline]
    pub(super) fn add(&mut self, interval: IntervalAcceleration, piece_m: f32, part: f32) {
        self.work_per_kg += interval.mean_mps2 * piece_m;
        self.known_m += piece_m;
        self.count += interval.count * part;
    }
}
