//! The latency of the receiver on a drive.

use estimator_core::Duration;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A latency, in units of 10 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Latency(u16);

impl From<Duration> for Latency {
    fn from(latency: Duration) -> Self {
        Self((latency.micros() / 10_000).min(u16::MAX.into()) as u16)
    }
}

impl Latency {
    /// Returns how much longer it is than another, s.
    pub(super) fn beyond_s(self, other: Self) -> f64 {
        0.01 * (f64::from(self.0) - f64::from(other.0))
    }
}

/// The latencies by which the fixes of a drive were placed.
#[derive(Debug, Default)]
pub(super) struct Latencies {
    first: Option<Latency>,
    /// Number of samples with each, since it was not the first any more.
    samples: BTreeMap<Latency, usize>,
}

impl Latencies {
    /// Takes the latency of the next sample.
    pub(super) fn note(&mut self, latency: Latency) {
        let first = *self.first.get_or_insert(latency);
        if latency != first || !self.samples.is_empty() {
            *self.samples.entry(latency).or_default() += 1;
        }
    }

    /// Returns the latency of the drive, if any other than the first was in use: the median since
    /// then. A receiver has one latency; what a part of the drive shows of it scatters.
    pub(super) fn learned(&self) -> Option<Latency> {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(millis: &[(u32, usize)]) -> Option<Latency> {
        let mut latencies = Latencies::default();
        for &(millis, count) in millis {
            for _ in 0..count {
                latencies.note(Duration::from_millis(millis).into());
            }
        }
        latencies.learned()
    }

    #[test]
    fn one_latency_is_nothing_learned() {
        assert_eq!(learned(&[]), None);
        assert_eq!(learned(&[(150, 1_000)]), None);
    }

    #[test]
    fn what_is_learned_counts_for_the_whole_drive() {
        assert_eq!(learned(&[(150, 1_000), (2_000, 1)]), Some(Latency(200)));
        assert_eq!(
            learned(&[
                (150, 50),
                (7_000, 20),
                (4_990, 20),
                (5_000, 60),
                (5_010, 20)
            ]),
            Some(Latency(500))
        );
    }

    #[test]
    fn what_is_soon_taken_back_was_wrong() {
        assert_eq!(
            learned(&[(150, 50), (7_000, 20), (150, 60)]),
            Some(Latency(15))
        );
    }
}
