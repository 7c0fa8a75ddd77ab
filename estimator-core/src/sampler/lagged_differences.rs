//! Differences of two signals at a row of lags: the lag at which they vary least is the delay of one
//! of them.
//!
//! Means and variances forget, and one reading updates a few lags, so that none takes long.

use crate::mean_and_variance::MeanAndVariance;
use heapless::Vec;

/// Mean and variance of the difference at each lag.
#[derive(Clone, Debug)]
pub(super) struct LaggedDifferences<const LAGS: usize> {
    /// Of a length that compilers do not know, so that they do not unroll loops.
    differences: Vec<MeanAndVariance, LAGS>,
    /// Lag that the next reading updates first.
    next: u8,
    /// Number of readings that updated the first lag.
    rounds: u16,
}

impl<const LAGS: usize> LaggedDifferences<LAGS> {
    pub(super) fn new() -> Self {
        Self {
            differences: Vec::from_array([MeanAndVariance::NONE; LAGS]),
            next: 0,
            rounds: 0,
        }
    }

    /// Returns the number of rounds that have begun.
    pub(super) const fn rounds(&self) -> u16 {
        self.rounds
    }

    /// Returns the part of a new difference that counts, with a memory of so many rounds.
    pub(super) fn gain(&self, memory: u16) -> f32 {
        // Not `clamp`, which panics if the limits are in the wrong order.
        1.0 / f32::from(self.rounds.min(memory).max(1))
    }

    /// Notes a reading. Returns whether a round over all lags begins with it.
    pub(super) fn begins_round(&mut self) -> bool {
        let begins = self.next == 0;
        if begins {
            self.rounds = self.rounds.saturating_add(1);
        }
        begins
    }

    /// Updates so many lags, a divisor of their number. `deviation` takes a lag and the mean of the
    /// difference there, and returns how far the difference is from it.
    pub(super) fn update(
        &mut self,
        count: u8,
        gain: f32,
        mut deviation: impl FnMut(usize, f32) -> Option<f32>,
    ) {
        for _ in 0..count {
            let lag = usize::from(self.next);
            self.next = (self.next + 1) % LAGS as u8;
            let Some(difference) = self.differences.get_mut(lag) else {
                return;
            };
            let Some(apart) = deviation(lag, difference.mean) else {
                return;
            };
            difference.add(apart, gain);
        }
    }

    /// Returns the mean at a lag; zero beyond the last one.
    pub(super) fn mean(&self, lag: usize) -> f32 {
        self.differences
            .get(lag)
            .map_or(0.0, |difference| difference.mean)
    }

    /// Returns the variance at a lag; infinity beyond the last one.
    pub(super) fn variance(&self, lag: usize) -> f32 {
        let found = self.differences.get(lag);
        found.map_or(f32::INFINITY, |difference| difference.variance)
    }

    /// Returns the lag of the least variance, the first one of equals.
    pub(super) fn best(&self) -> usize {
        let mut best = (0, f32::INFINITY);
        for (lag, difference) in self.differences.iter().enumerate() {
            if difference.variance < best.1 {
                best = (lag, difference.variance);
            }
        }
        best.0
    }
}
