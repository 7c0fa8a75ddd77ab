//! Measurement noise learned from innovations, as a ratio of learned to assumed variance.
//!
//! Sensors differ: the wheel speeds of one make are three times as noisy as another's. If the
//! assumed variance were right, the mean of the normalised squared innovation would be one. The
//! ratio follows that mean (R. K. Mehra, "On the identification of variances and adaptive Kalman
//! filtering", IEEE Trans. Automatic Control 15:175, 1970).

use crate::scalar::Scalar;
use crate::tuning::MeasurementNoise;
use core::ops::RangeInclusive;

/// Learned over assumed variance of each sensor noise, 1.
///
/// Sensors change less than drives do, so the ratios may be kept for the next drive, or for a
/// second pass over the same one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorNoiseRatios {
    /// White noise of the wheel speed.
    pub speed: f32,
    /// White noise of the GNSS altitude.
    pub altitude: f32,
    /// Coloured error of the GNSS altitude.
    pub gnss_error: f32,
}

impl Default for SensorNoiseRatios {
    /// Returns ratios of one: the variances are as assumed.
    fn default() -> Self {
        Self {
            speed: 1.0,
            altitude: 1.0,
            gnss_error: 1.0,
        }
    }
}

/// Returns the sigma that a ratio of variances makes of an assumed one.
pub fn learned_sigma(ratio: f32, assumed_sigma: f32) -> f32 {
    Scalar::sqrt(ratio) * assumed_sigma
}

/// Returns learned over assumed variance of two sigmas.
pub fn variance_ratio(learned_sigma: f32, assumed_sigma: f32) -> f32 {
    let part = learned_sigma / assumed_sigma;
    part * part
}

/// The ratio for white noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseRatio {
    ratio: f32,
    low: f32,
    high: f32,
    gain: f32,
}

impl NoiseRatio {
    /// Creates the ratio with its limits. `gain` is the part of an innovation by which it follows.
    pub(super) fn new(ratio: f32, low: f32, high: f32, gain: f32) -> Self {
        Self {
            ratio: within(ratio, low..=high),
            low,
            high,
            gain,
        }
    }

    /// Sets the ratio, within its limits.
    pub(super) fn set(&mut self, ratio: f32) {
        self.ratio = within(ratio, self.low..=self.high);
    }

    /// Returns learned over assumed variance.
    pub(super) const fn ratio(&self) -> f32 {
        self.ratio
    }

    /// Learns from a normalised squared innovation, which counts as `largest` at most.
    #[inline(never)] // Called from several places.
    pub(super) fn learn(&mut self, normalised: f32, largest: f32) {
        let factor = 1.0 + self.gain * (Scalar::min(largest, normalised) - 1.0);
        self.set(self.ratio * factor);
    }
}

/// The ratio for a coloured error, learned from sums of successive innovations.
///
/// An error that keeps its value over many readings hardly shows in a single innovation, where white
/// noise dominates, but it moves them all the same way. If its variance were right, innovations
/// would be uncorrelated (Mehra, as above), and the square of their sum would be the sum of their
/// variances in the mean. It is larger if the coloured error is larger than assumed, and smaller if
/// it is smaller. The sum covers a time in which faster errors average out and the slow one does
/// not change its sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct CorrelatedNoiseRatio {
    ratio: f32,
    elapsed_s: f32,
    sum: f32,
    variance: f32,
    /// Number of sums that the ratio is a mean over.
    weight: u8,
}

impl CorrelatedNoiseRatio {
    /// Creates the ratio. A ratio of exactly one means that nothing is known yet.
    pub(super) fn new(ratio: f32, tuning: &MeasurementNoise) -> Self {
        let is_known = ratio != 1.0;
        Self {
            ratio: within(ratio, limits(tuning)),
            elapsed_s: 0.0,
            sum: 0.0,
            variance: 0.0,
            weight: if is_known {
                tuning.gnss_error_last_weight
            } else {
                tuning.gnss_error_first_weight
            },
        }
    }

    /// Returns learned over assumed variance.
    pub(super) const fn ratio(&self) -> f32 {
        self.ratio
    }

    /// Advances the time.
    pub(super) fn advance(&mut self, duration_s: f32) {
        self.elapsed_s += duration_s;
    }

    /// Drops an unfinished sum: the next innovation does not follow the last one.
    pub(super) fn interrupt(&mut self) {
        self.elapsed_s = 0.0;
        self.sum = 0.0;
        self.variance = 0.0;
    }

    /// Learns from an innovation with its variance.
    #[inline]
    pub(super) fn learn(&mut self, innovation: f32, variance: f32, tuning: &MeasurementNoise) {
        self.sum += innovation;
        self.variance += variance;
        if self.elapsed_s < tuning.gnss_error_sum_s {
            return;
        }
        let largest = tuning.gnss_error_largest_sum;
        let squared = Scalar::min(self.sum * self.sum / self.variance, largest);
        let factor = 1.0 + (squared - 1.0) / f32::from(self.weight);
        self.ratio = within(self.ratio * factor, limits(tuning));
        self.weight = self
            .weight
            .saturating_add(1)
            .min(tuning.gnss_error_last_weight);
        self.interrupt();
    }
}

fn limits(tuning: &MeasurementNoise) -> RangeInclusive<f32> {
    tuning.gnss_error_ratio_low..=tuning.gnss_error_ratio_high
}

/// Not `clamp`, which panics if the limits are in the wrong order, with a message that brings the
/// formatting of floats into an image.
fn within(value: f32, limits: RangeInclusive<f32>) -> f32 {
    Scalar::min(*limits.end(), Scalar::max(*limits.start(), value))
}
