//! Delays that an earlier drive has found.

use estimator_core::{Delay, Estimator, PersistentState, Tuning};
use std::sync::LazyLock;
use test_kit::by_force;
use test_kit::late_drive::{Late, LateDrive};

const LATE: Late = Late {
    receiver_s: 2.0,
    traction_s: 1.0,
    altitude_s: 10.0,
};

/// What ten minutes with such delays leave.
static KEPT: LazyLock<PersistentState> = LazyLock::new(|| {
    let estimator = Estimator::new(by_force(), Tuning::default()).unwrap();
    let mut drive = LateDrive::of(estimator, 3);
    drive.on(600, LATE);
    let kept = drive.estimator.persistent_state().unwrap();
    assert_eq!(*kept.delays(), drive.estimator.delays());
    kept
});

/// Begins a drive with what is kept, as it is stored.
fn next_drive() -> LateDrive {
    let state = PersistentState::from_bytes(&KEPT.to_bytes()).unwrap();
    assert_eq!(state, *KEPT);
    let estimator = Estimator::restore(by_force(), Tuning::default(), &state).unwrap();
    LateDrive::of(estimator, 5)
}

#[test]
fn a_kept_delay_counts_at_once() {
    let mut drive = next_drive();
    assert_eq!(drive.estimator.delays(), *KEPT.delays());
    let latency_s = drive.estimator.gnss_latency().seconds();
    assert!((latency_s - 2.0).abs() < 0.1, "{latency_s}");
    drive.on(2, LATE);
    let sample = drive.estimator.sample().unwrap();
    assert!((sample.traction_late_s - 1.0).abs() < 0.2);
}

#[test]
fn a_kept_delay_stays_while_the_drive_agrees_or_shows_nothing() {
    let mut drive = next_drive();
    for _ in 0..20 {
        drive.on(60, LATE);
        let delays = drive.estimator.delays();
        let off_s = |delay: Delay, true_s: f32| (delay.estimated_s().unwrap() - true_s).abs();
        assert!(off_s(delays.receiver, 2.0) < 0.1);
        assert!(off_s(delays.traction, 1.0) < 0.2);
        assert!(off_s(delays.altitude, 10.0) < 3.0);
    }
}

#[test]
fn a_kept_delay_that_the_drive_contradicts_is_dropped() {
    let mut drive = next_drive();
    drive.on(600, Late::IN_TIME);
    let delays = drive.estimator.delays();
    assert_eq!(delays.receiver, Delay::Unestimated);
    assert_eq!(delays.traction, Delay::Unestimated);
    assert_eq!(delays.altitude, Delay::Unestimated);
    // It is not kept any more either.
    let state = drive.estimator.persistent_state().unwrap();
    assert_eq!(*state.delays(), delays);
}

#[test]
fn a_kept_delay_follows_a_receiver_that_is_later_now() {
    let mut drive = next_drive();
    let later = Late {
        receiver_s: 5.0,
        ..LATE
    };
    drive.on(600, later);
    let delays = drive.estimator.delays();
    assert!((delays.receiver.estimated_s().unwrap() - 5.0).abs() < 0.1);
}
