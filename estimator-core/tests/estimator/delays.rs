//! How late receiver and force are found to be.

use estimator_core::{Delay, Delays, Estimator, Tuning};
use test_kit::by_force;
use test_kit::late_drive::{Late, LateDrive};

/// Drives so long.
fn driven(late: Late, minutes: u32) -> LateDrive {
    let estimator = Estimator::new(by_force(), Tuning::default()).unwrap();
    let mut drive = LateDrive::of(estimator, 7);
    drive.on(60 * minutes, late);
    drive
}

/// Returns the delay, whose sigma is below 0.04 s.
fn found_s(delay: Delay) -> f32 {
    let Delay::Estimated { delay_s, sigma_s } = delay else {
        panic!("{delay:?}");
    };
    assert!(sigma_s > 0.001 && sigma_s < 0.04, "{delay:?}");
    delay_s
}

#[test]
fn a_late_receiver_is_found_on_wheels_that_slip() {
    for receiver_s in [0.3, 0.6, 1.13, 2.0, 5.0] {
        let late = Late {
            receiver_s,
            ..Late::IN_TIME
        };
        let delays = driven(late, 10).estimator.delays();
        let found_s = found_s(delays.receiver);
        let off_s = found_s - receiver_s;
        assert!(off_s.abs() < 0.05, "{receiver_s} s late: {found_s} s");
        assert_eq!(delays.traction, Delay::Unestimated);
    }
}

#[test]
fn a_late_force_is_found() {
    for traction_s in [0.5, 1.0, 2.0, 2.8] {
        let late = Late {
            traction_s,
            ..Late::IN_TIME
        };
        let delays = driven(late, 10).estimator.delays();
        // Wheels that slip under a force are ahead of the vehicle, by 0.15 s here.
        let off_s = found_s(delays.traction) - traction_s;
        assert!(
            (-0.05..0.2).contains(&off_s),
            "{traction_s} s late: {off_s}"
        );
    }
}

#[test]
fn both_are_found_at_once() {
    let late = Late {
        receiver_s: 1.6,
        traction_s: 1.0,
        ..Late::IN_TIME
    };
    let delays = driven(late, 30).estimator.delays();
    assert!((found_s(delays.receiver) - 1.6).abs() < 0.1, "{delays:?}");
    assert!((found_s(delays.traction) - 1.0).abs() < 0.2, "{delays:?}");
}

#[test]
fn the_low_pass_of_a_receiver_on_altitudes_is_found() {
    for altitude_s in [5.0, 10.0, 20.0, 30.0] {
        let late = Late {
            altitude_s,
            ..Late::IN_TIME
        };
        let mut drive = driven(late, 0);
        drive.on(1_800, late);
        let Delay::Estimated { delay_s, sigma_s } = drive.estimator.delays().altitude else {
            panic!("{altitude_s} s: {:?}", drive.estimator.delays());
        };
        let off_s = (delay_s - altitude_s).abs();
        assert!(
            off_s < 3.0 * sigma_s && sigma_s < 0.25 * altitude_s,
            "{altitude_s} s: {delay_s} ± {sigma_s} s"
        );
    }
}

#[test]
fn what_comes_in_time_has_no_other_delay() {
    for minutes in [2, 10, 60] {
        let estimator = driven(Late::IN_TIME, minutes).estimator;
        assert_eq!(estimator.delays(), Delays::default());
        let assumed = estimator.tuning().hold_times.gnss_latency;
        assert_eq!(estimator.gnss_latency(), assumed);
    }
}

/// The torque that comes back behind a shift does not explain what the open clutch did.
#[test]
fn a_force_that_rises_behind_shifts_is_in_time() {
    let mut drive = driven(Late::IN_TIME, 0);
    drive.shifts = true;
    drive.on(3_600, Late::IN_TIME);
    assert_eq!(drive.estimator.delays(), Delays::default());
}

#[test]
fn a_receiver_that_is_later_than_can_be_found_is_told_and_assumed_to_be_usual() {
    let late = Late {
        receiver_s: 9.5,
        ..Late::IN_TIME
    };
    let estimator = driven(late, 20).estimator;
    assert_eq!(estimator.delays().receiver, Delay::Invalid);
    let assumed = estimator.tuning().hold_times.gnss_latency;
    assert_eq!(estimator.gnss_latency(), assumed);
}

#[test]
fn another_receiver_has_another_delay() {
    let late = Late {
        receiver_s: 2.0,
        ..Late::IN_TIME
    };
    let mut drive = driven(late, 10);
    assert!(drive.estimator.delays().receiver.estimated_s().is_some());
    drive.receiver = 0x2c;
    drive.on(60, Late::IN_TIME);
    assert_eq!(drive.estimator.counters().source_switches, 1);
    assert_eq!(drive.estimator.delays().receiver, Delay::Unestimated);
    drive.on(600, Late::IN_TIME);
    assert_eq!(drive.estimator.delays().receiver, Delay::Unestimated);
}
