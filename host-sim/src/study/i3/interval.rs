//! Intervals of a statistic over trips.

use crate::numeric::statistics::quantile;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Draws of the bootstrap.
const DRAWS: usize = 2_000;

/// A statistic and its interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) value: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Computes a statistic over trips, and its interval by drawing trips with replacement (bootstrap).
pub(super) fn interval(values: &[f64], seed: u64, of: fn(&[f64]) -> f64) -> Option<Interval> {
    if values.is_empty() {
        return None;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let draws: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let drawn: Vec<f64> = (0..values.len())
                .map(|_| values[rng.random_range(0..values.len())])
                .collect();
            of(&drawn)
        })
        .collect();
    Some(Interval {
        value: of(values),
        low: quantile(draws.iter().copied(), 0.025),
        high: quantile(draws, 0.975),
    })
}
