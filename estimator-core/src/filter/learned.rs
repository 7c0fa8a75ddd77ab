//! Measurement noise learned from innovations.
//!
//! Sensors differ: wheel speeds of one make are three times as noisy as another's. If the stated
//! variance were right, the mean of the normalised squared innovation would be one; the variance
//! follows it (R. K. Mehra, "On the identification of variances and adaptive Kalman filtering",
//! IEEE Trans. Automatic Control 15:175, 1970).

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
    /// One at first, and from `least` to `most`; `step` is the part of a lesson that is taken.
    pub(super) const fn new(least: f32, most: f32, step: f32) -> Self {
        Self {
            ratio: 1.0,
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
        let lesson = 1.0 + self.step * (normalised.min(LARGEST_LESSON) - 1.0);
        self.ratio = (self.ratio * lesson).clamp(self.least, self.most);
    }
}
