//! The Gauss-Markov process: an error that is forgotten over a length or a time.

/// One step of a first-order Gauss-Markov process: x⁺ = k x + w, var w = (1 − k²) σ².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GaussMarkov {
    /// The part k of the state that is left.
    pub keep: f32,
    /// The variance of w.
    pub variance: f32,
}

impl GaussMarkov {
    /// Creates the step for a length or time in correlation lengths or times, and the variance σ².
    pub(super) fn step(correlation_lengths: f32, variance: f32) -> Self {
        let keep = 1.0 / (1.0 + correlation_lengths);
        Self {
            keep,
            variance: (1.0 - keep * keep) * variance,
        }
    }
}
