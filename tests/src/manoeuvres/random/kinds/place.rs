//! Where something begins.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Where manoeuvres begin, m.
const ONSETS_M: Range<f64> = 6_000.0..26_000.0;

/// Draws where something begins, m.
pub fn onset(rng: &mut ChaCha8Rng) -> f64 {
    rng.random_range(ONSETS_M).round()
}

/// Returns a distance, m, in words.
pub fn km(distance_m: f64) -> String {
    format!("km {:.1}", 1e-3 * distance_m)
}
