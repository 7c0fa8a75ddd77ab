//! The latency of the receiver on a drive.

use estimator_core::Duration;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A latency, in units of 10 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
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
    /// Number of samples with each, since it was not the first any more.
    samples: BTreeMap<Latency, usize>,
}

impl Latencies {
    /// Takes the latency of the next sample.
    pub fn note(&mut self, latency: Latency) {
        let first = *self.first.get_or_insert(latency);
        if latency != first || !self.samples.is_empty() {
            *self.samples.entry(latency).or_default() += 1;
        }
    }

    /// Returns the latency of the drive, if any other than the first was in use: the median since
    /// then. A receiver has one latency; what a part of the drive shows of it scatters.
    pub fn learned(&self) -> Option<Latency> {
        let mut left = self.samples.values().sum::<usize>() / 2;
        for (latency, count) in &self.samples {
            if left < *count {
                return Some(*latency);
            }
            left -= count;
        }
        None
    }
}
