//! The way that a speed signal gives.

use estimator_core::Instant;

/// The integral of a speed over time. Intervals of any length count: a clock that is not in seconds
/// makes them long.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integral {
    last: Option<(Instant, f64)>,
    metres: f64,
}

impl Integral {
    /// Takes a speed, m/s. Returns the time since the last one, s.
    pub(super) fn add(&mut self, now: Instant, mps: f64) -> Option<f64> {
        let last = self.last.replace((now, mps));
        let (time, last_mps) = last?;
        let seconds = now.since(time).as_secs_f64();
        self.metres += 0.5 * (last_mps + mps) * seconds;
        Some(seconds)
    }

    /// Returns the way so far, m.
    pub(super) const fn metres(&self) -> f64 {
        self.metres
    }

    /// Returns the newest speed, m/s.
    pub(super) fn speed_mps(&self) -> Option<f64> {
        self.last.map(|(_, mps)| mps)
    }
}
