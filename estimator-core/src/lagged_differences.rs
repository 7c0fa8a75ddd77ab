//! Differences of two signals at a row of lags: the lag at which they vary least is the delay of one
//! of them.
//!
//! Means and variances forget, and one reading updates a few lags, so that none takes long.

/// Mean and variance of the difference at each lag.
#[derive(Clone, Debug)]
pub(crate) struct LaggedDifferences<const LAGS: usize> {
    mean_and_variance: [(f32, f32); LAGS],
    /// Lag that the next reading updates first.
    next: u8,
    /// Number of readings that updated the first lag.
    rounds: u16,
}

impl<const LAGS: usize> LaggedDifferences<LAGS> {
    pub(crate) const fn new() -> Self {
        Self {
            mean_and_variance: [(0.0, 0.0); LAGS],
            next: 0,
            rounds: 0,
        }
    }

    /// Returns the differences found so far, to be updated from the first lag on.
    pub(crate) const fn restarted(&self) -> Self {
        Self { next: 0, ..*self }
    }

    /// Returns the number of rounds that have begun.
    pub(crate) const fn rounds(&self) -> u16 {
        self.rounds
    }

    /// Returns the part of a new difference that counts, with a memory of so many rounds.
    pub(crate) fn gain(&self, memory: u16) -> f32 {
        // Not `clamp`, which panics if the limits are in the wrong order.
        1.0 / f32::from(self.rounds.min(memory).max(1))
    }

    /// Notes a reading. Returns whether a round over all lags begins with it.
    pub(crate) fn begins_round(&mut self) -> bool {
        let begins = self.next == 0;
        if begins {
            self.rounds = self.rounds.saturating_add(1);
        }
        begins
    }

    /// Updates so many lags, a divisor of their number. `deviation` takes a lag and the mean of the
    /// difference there, and returns how far the difference is from it.
    pub(crate) fn update(
        &mut self,
        count: u8,
        gain: f32,
        mut deviation: impl FnMut(usize, f32) -> Option<f32>,
    ) {
        for _ in 0..count {
            let lag = usize::from(self.next);
            self.next = (self.next + 1) % LAGS as u8;
            let Some(mean_and_variance) = self.mean_and_variance.get_mut(lag) else {
                return;
            };
            let Some(apart) = deviation(lag, mean_and_variance.0) else {
                return;
            };
            add_deviation(mean_and_variance, gain, apart);
        }
    }

    /// Returns the mean at a lag; zero beyond the last one.
    pub(crate) fn mean(&self, lag: usize) -> f32 {
        self.mean_and_variance
            .get(lag)
            .map_or(0.0, |(mean, _)| *mean)
    }

    /// Returns the variance at a lag; infinity beyond the last one.
    pub(crate) fn variance(&self, lag: usize) -> f32 {
        let found = self.mean_and_variance.get(lag);
        found.map_or(f32::INFINITY, |(_, variance)| *variance)
    }

    /// Returns the lag of the least variance, the first one of equals.
    pub(crate) fn best(&self) -> usize {
        least_variance(&self.mean_and_variance)
    }
}

/// Updates a mean and a variance with a deviation from the mean.
#[inline(never)] // Compilers do not unroll a loop with a call.
fn add_deviation((mean, variance): &mut (f32, f32), gain: f32, apart: f32) {
    *mean += gain * apart;
    *variance = (1.0 - gain) * (*variance + gain * apart * apart);
}

/// Returns the index of the least variance, the first one of equals.
#[inline(never)] // Of any length, so that no compiler unrolls it.
fn least_variance(mean_and_variance: &[(f32, f32)]) -> usize {
    let first = mean_and_variance.first();
    let mut best = (0, first.map_or(f32::INFINITY, |(_, variance)| *variance));
    for (lag, (_, variance)) in mean_and_variance.iter().enumerate() {
        if *variance < best.1 {
            best = (lag, *variance);
        }
    }
    best.0
}
