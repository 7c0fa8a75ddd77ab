//! The latency of the receiver on a drive.

use estimator_core::Duration;
use serde::{Deserialize, Serialize};

/// A latency, in units of 10 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Latency(u16);

impl From<Duration> for Latency {
    fn from(latency: Duration) -> Self {
        Self((latency.micros() / 10_000).min(u16::MAX.into()) as u16)
    }
}

impl Latency {
    /// Returns how much longer it is than another, s.
    pub fn beyond_s(self, other: Self) -> f64 {
        0.01 * (f64::from(self.0) - f64::from(other.0))
    }
}

/// The latencies by which the fixes of a drive were placed.
#[derive(Debug, Default)]
pub struct Latencies {
    first: Option<Latency>,
    last: Option<Latency>,
    /// Whether any other than the first was in use.
    was_learned: bool,
}

impl Latencies {
    /// Takes the latency of the next sample.
    pub fn note(&mut self, latency: Latency) {
        let first = *self.first.get_or_insert(latency);
        self.was_learned |= latency != first;
        self.last = Some(latency);
    }

    /// Returns the latency of the drive, if any other than the first was in use: the last, which the
    /// whole drive shows.
    pub fn learned(&self) -> Option<Latency> {
        self.last.filter(|_| self.was_learned)
    }
}
