//! Accelerometer and pitch sensor: what they read beside the force balance.
//!
//! Both read the slope with an offset that no other signal tells from the model's bias. The offset is
//! therefore a running mean of what they read beyond the force balance where that holds. Where the
//! force is not known (shifts, brakes, a silent engine), they stand in for it.

use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Cells of the mean of a moment, 20 m.
const MOMENT_CELLS: f32 = 8.0;
/// Cells in which a disagreement may have begun that is noticed now.
pub(super) const NOTICED_CELLS: f32 = 10.0;
/// Cells from which on the offset is known, 250 m.
const KNOWN_CELLS: f32 = 100.0;
/// Difference that is no disagreement, %: body and driveline take it up.
const LEAST_PERCENT: f32 = 0.7;
/// Sigmas of the usual difference beyond which there is one.
const SIGMAS: f32 = 6.0;

/// A sensor on the body, beside the force balance.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodySensor {
    /// Mean of what the sensor reads beyond the force balance, %.
    offset_percent: f32,
    /// Variance of the difference from it in a cell, as white noise that explains its moments, %².
    variance: f32,
    /// The mean of the moment less the offset, %.
    moment_percent: f32,
    /// Cells so far, up to those of the memory.
    cells: f32,
}

impl BodySensor {
    pub(super) const fn new() -> Self {
        Self {
            offset_percent: 0.0,
            variance: 1.0,
            moment_percent: 0.0,
            cells: 0.0,
        }
    }

    /// Takes what the sensor reads in a cell in which the force balance holds, and what that reads, %.
    pub(super) fn compare(&mut self, numbers: &Numbers, sensor_percent: f32, model_percent: f32) {
        let difference = sensor_percent - model_percent;
        if !difference.is_finite() {
            return;
        }
        self.cells = Scalar::min(self.cells + 1.0, numbers.body_sensor_cells);
        let error = difference - self.offset_percent;
        self.moment_percent += (error - self.moment_percent) / MOMENT_CELLS;
        // What one of the two has wrong is no offset.
        let part = if self.disagrees() > 0.0 { 0.1 } else { 1.0 };
        self.offset_percent += part * error / self.cells;
        // What lasts for a moment is no white noise. A running mean over N cells has 1/(2 N − 1) of its
        // variance.
        let squared = (2.0 * MOMENT_CELLS - 1.0) * self.moment_percent.squared();
        let bounded = Scalar::min(squared, 25.0 * self.variance);
        self.variance += part * (bounded - self.variance) / self.cells;
    }

    /// Returns the slope that the sensor reads, %, and the variance of a cell's reading; `None` while
    /// its offset is unknown.
    pub(super) fn slope(&self, sensor_percent: f32) -> Option<(f32, f32)> {
        let is_known = self.cells >= KNOWN_CELLS;
        is_known.then_some((sensor_percent - self.offset_percent, self.variance))
    }

    /// Returns by how much sensor and force balance disagree at the moment, %; zero where their noise
    /// explains it.
    pub(super) fn disagrees(&self) -> f32 {
        let moment = self.moment_percent.abs();
        let usual = Scalar::sqrt(self.variance / (2.0 * MOMENT_CELLS - 1.0));
        let is_known = self.cells >= KNOWN_CELLS;
        if is_known && moment > Scalar::max(LEAST_PERCENT, SIGMAS * usual) {
            moment
        } else {
            0.0
        }
    }
}
