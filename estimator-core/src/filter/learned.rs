//! Measurement noise learned from innovations.
//!
//! Sensors differ: wheel speeds of one make are three times as noisy as another's. If the stated
//! variance were right, the mean of the normalised squared innovation would be one; the variance
//! follows it (R. K. Mehra, "On the identification of variances and adaptive Kalman filtering",
//! IEEE Trans. Automatic Control 15:175, 1970).

use crate::scalar::Scalar;

/// How noisy the sensors turned out to be: learned over believed variance of each noise. Sensors
/// change less than drives do, so it may be kept for the next drive, or for a second look at this
/// one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorNoise {
    /// Wheel speed, white.
    pub speed: f32,
    /// GNSS altitude, white.
    pub altitude: f32,
    /// GNSS altitude, slow.
    pub gnss_error: f32,
}

impl Default for SensorNoise {
    /// As believed.
    fn default() -> Self {
        Self {
            speed: 1.0,
            altitude: 1.0,
            gnss_error: 1.0,
        }
    }
}

/// Learned over believed variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    ratio: f32,
    least: f32,
    most: f32,
    step: f32,
}

/// Largest normalised squared innovation that teaches: what is beyond is no noise.
const LARGEST_LESSON: f32 = 25.0;

impl Spread {
    /// `ratio` at first, and from `least` to `most`; `step` is the part of a lesson that is taken.
    pub(super) fn new(ratio: f32, least: f32, most: f32, step: f32) -> Self {
        Self {
            ratio: ratio.max(least).min(most),
            least,
            most,
            step,
        }
    }

    /// Learned over believed variance.
    pub(super) const fn ratio(&self) -> f32 {
        self.ratio
    }

    /// Takes in a normalised squared innovation.
    pub(super) fn learn(&mut self, normalised: f32) {
        let lesson = 1.0 + self.step * (Scalar::min(LARGEST_LESSON, normalised) - 1.0);
        // Not `clamp`: it panics, with a message that drags the printing of floats into the image.
        self.ratio = Scalar::min(self.most, Scalar::max(self.least, self.ratio * lesson));
    }
}

/// Size of a slow error, learned from sums of successive innovations.
///
/// An error that keeps its value over many readings hardly shows in a single innovation, which
/// white noise fills, but it moves them all the same way: if its variance were right, innovations
/// would be uncorrelated (Mehra, as above) and the square of their sum would be the sum of their
/// variances on average. It is more if the slow error is larger than believed, less if it is
/// smaller. The sum runs over a stretch in which faster errors average out and the slow one does
/// not turn round.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlowSpread {
    ratio: f32,
    stretch_s: f32,
    passed_s: f32,
    sum: f32,
    variance: f32,
    weight: u8,
}

/// Stretches that count as much as the newest one: at first, and in the end.
const WEIGHTS: core::ops::Range<u8> = 3..25;
/// Largest squared sum over its variance that teaches.
const LARGEST_SUM: f32 = 9.0;
/// Least and largest ratio.
const RATIOS: core::ops::RangeInclusive<f32> = 0.01..=100.0;

impl SlowSpread {
    /// `ratio` at first, of which nothing is sure if it is one; `stretch_s` is the length of a sum.
    pub(super) fn new(ratio: f32, stretch_s: f32) -> Self {
        let known = ratio != 1.0;
        Self {
            ratio: ratio.clamp(*RATIOS.start(), *RATIOS.end()),
            stretch_s,
            passed_s: 0.0,
            sum: 0.0,
            variance: 0.0,
            weight: if known { WEIGHTS.end } else { WEIGHTS.start },
        }
    }

    /// Learned over believed variance.
    pub(super) const fn ratio(&self) -> f32 {
        self.ratio
    }

    /// Time goes on.
    pub(super) fn pass(&mut self, duration_s: f32) {
        self.passed_s += duration_s;
    }

    /// Leaves an unfinished sum: the next innovation does not follow the last.
    pub(super) fn interrupt(&mut self) {
        self.passed_s = 0.0;
        self.sum = 0.0;
        self.variance = 0.0;
    }

    /// Takes in an innovation and its variance.
    #[inline]
    pub(super) fn learn(&mut self, innovation: f32, variance: f32) {
        self.sum += innovation;
        self.variance += variance;
        if self.passed_s < self.stretch_s {
            return;
        }
        let squared = Scalar::min(self.sum * self.sum / self.variance, LARGEST_SUM);
        let lesson = 1.0 + (squared - 1.0) / f32::from(self.weight);
        self.ratio = (self.ratio * lesson).clamp(*RATIOS.start(), *RATIOS.end());
        self.weight = (self.weight + 1).min(WEIGHTS.end);
        self.interrupt();
    }
}
