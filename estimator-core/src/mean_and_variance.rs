//! Mean and variance of values that come one by one. The oldest are forgotten.

/// Mean and variance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeanAndVariance {
    pub mean: f32,
    pub variance: f32,
}

impl MeanAndVariance {
    /// Before the first value.
    pub(crate) const NONE: Self = Self {
        mean: 0.0,
        variance: 0.0,
    };

    /// Adds a value, by how far it is from the mean. It counts for the part `gain`.
    #[inline(never)] // Called from three places.
    pub(crate) fn add(&mut self, apart: f32, gain: f32) {
        self.mean += gain * apart;
        self.variance = (1.0 - gain) * (self.variance + gain * apart * apart);
    }
}
