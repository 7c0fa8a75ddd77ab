//! Drives with two or three manoeuvres or faults at once, drawn at random.

mod kinds;

use super::drives::{BenchTruck, Plan};
use kinds::KINDS;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Stretches of the road that drives are on.
const STRETCHES: Range<u64> = 1..5;

/// Returns `count` drives; the same for the same seed.
#[must_use]
pub fn drawn(count: usize, seed: u64) -> Vec<Plan> {
    (0..count)
        .map(|index| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index as u64);
            draw(&mut rng)
        })
        .collect()
}

fn draw(rng: &mut ChaCha8Rng) -> Plan {
    let truck = BenchTruck::ALL[rng.random_range(0..BenchTruck::ALL.len())];
    let mut plan = Plan::new("", truck, rng.random_range(STRETCHES));
    let wanted = rng.random_range(2..=3);
    let mut names: Vec<String> = Vec::new();
    let mut kinds = Vec::new();
    while names.len() < wanted {
        let kind = rng.random_range(0..KINDS.len());
        if kinds.contains(&kind) {
            continue;
        }
        if let Some(name) = KINDS[kind](&mut plan, rng) {
            names.push(name);
            kinds.push(kind);
        }
    }
    plan.name = names.join(" + ");
    plan
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_draws_the_same_drives() {
        let text = |seed| format!("{:?}", drawn(20, seed));
        assert_eq!(text(3), text(3));
        assert_ne!(text(3), text(4));
        assert!(drawn(20, 3).iter().all(|plan| plan.faults.len() > 1));
    }
}
