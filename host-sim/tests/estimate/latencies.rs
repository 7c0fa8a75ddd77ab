//! The latency of the receiver on a drive, learned from those by which its fixes were placed.

use estimator_core::Duration;
use host_sim::recorder::latencies::{Latencies, Latency};

fn latency(millis: u32) -> Latency {
    Duration::from_millis(millis).into()
}

fn learned(millis: &[(u32, usize)]) -> Option<Latency> {
    let mut latencies = Latencies::default();
    for &(millis, count) in millis {
        for _ in 0..count {
            latencies.note(latency(millis));
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
    assert_eq!(learned(&[(150, 1_000), (2_000, 1)]), Some(latency(2000)));
    // The last one is what the whole drive shows.
    assert_eq!(
        learned(&[(150, 50), (7_000, 20), (4_990, 60), (5_000, 20)]),
        Some(latency(5000))
    );
}

#[test]
fn what_is_soon_taken_back_was_wrong() {
    assert_eq!(
        learned(&[(150, 50), (7_000, 20), (150, 60)]),
        Some(latency(150))
    );
}
