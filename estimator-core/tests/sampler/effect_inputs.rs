//! The inputs of effects, from readings.

use estimator_core::Signal;
use estimator_core::sample::{EffectInputs, Sample};
use test_kit::by_force;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::truck;

const FORCE: (Signal, f32) = (Signal::TractionForce, 4_000.0);

fn at(speed_mps: f32) -> (Signal, f32) {
    (Signal::WheelSpeed, speed_mps)
}

fn last(samples: &[Sample]) -> EffectInputs {
    samples.last().expect("a cell was driven").effect_inputs
}

#[test]
fn inputs_are_known_until_they_are_stale() {
    let mut drive = ReadingsDrive::of(by_force());
    let readings = [
        FORCE,
        (Signal::Fan, 40.0),
        (Signal::AmbientTemperature, -5.0),
        (Signal::YawRate, 0.02),
        (Signal::Course, 80.0),
        (Signal::GnssSpeed, 19.5),
        at(20.0),
    ];
    let known = last(&drive.on(5.0, &readings));
    assert_eq!(known.fan_percent.get(), Some(40.0));
    assert_eq!(known.ambient_celsius.get(), Some(-5.0));
    assert!((known.yaw_rate_radps.get().unwrap() - 0.02).abs() < 1e-6);
    assert_eq!(known.course_deg.get(), Some(80.0));
    assert_eq!(known.gnss_speed_mps.get(), Some(19.5));
    assert!(known.engaged);

    let silent = last(&drive.on(3.0, &[FORCE, at(20.0)]));
    assert_eq!(silent.yaw_rate_radps.get(), None);
    assert_eq!(silent.course_deg.get(), None);
    assert_eq!(silent.gnss_speed_mps.get(), None);
    // The fan is reported once a second.
    assert_eq!(silent.fan_percent.get(), Some(40.0));
    let longer = last(&drive.on(3.0, &[FORCE, at(20.0)]));
    assert_eq!(longer.fan_percent.get(), None);
}

#[test]
fn impossible_values_are_not_known() {
    let mut drive = ReadingsDrive::of(by_force());
    for (signal, values) in [
        (Signal::Fan, [-1.0, 101.0, f32::NAN]),
        (Signal::YawRate, [3.0, -3.0, f32::INFINITY]),
        (Signal::Course, [-1.0, 361.0, f32::NAN]),
        (Signal::GnssSpeed, [-1.0, 71.0, f32::NAN]),
    ] {
        for value in values {
            let known = last(&drive.on(1.0, &[FORCE, (signal, value), at(20.0)]));
            let plain = EffectInputs {
                driven_s: known.driven_s,
                engaged: true,
                ..EffectInputs::default()
            };
            assert_eq!(known, plain, "{signal:?} {value}");
        }
    }
}

#[test]
fn the_yaw_rate_is_the_mean_of_its_cell() {
    let mut drive = ReadingsDrive::of(by_force());
    // Two readings to each 100 ms: 2 m.
    let readings = [
        FORCE,
        (Signal::YawRate, 0.01),
        (Signal::YawRate, 0.05),
        at(20.0),
    ];
    for sample in drive.on(10.0, &readings) {
        let yaw_rate = sample.effect_inputs.yaw_rate_radps.get().unwrap();
        assert!((yaw_rate - 0.03).abs() < 1e-6, "{yaw_rate}");
    }
}

#[test]
fn without_a_yaw_rate_it_comes_from_the_course() {
    let mut drive = ReadingsDrive::of(by_force());
    // To the left, through north: 2° a second, with a reading every 200 ms.
    let mut found = None;
    for step in 0..60_u16 {
        let course_deg = (370.0 - 0.4 * f32::from(step)) % 360.0;
        drive.on(0.1, &[FORCE, (Signal::Course, course_deg), at(20.0)]);
        if let Some(sample) = drive.on(0.1, &[FORCE, at(20.0)]).last() {
            found = sample.effect_inputs.yaw_rate_radps.get();
        }
    }
    let expected = 2.0_f32.to_radians();
    assert!(
        (found.unwrap() - expected).abs() < 0.01 * expected,
        "{found:?}"
    );
    // Its mean follows a turn to the right within some 50 m.
    let mut distance_m = 0.0;
    for step in 0..100_u16 {
        let course_deg = 346.0 + 0.4 * f32::from(step) % 14.0;
        let readings = [FORCE, (Signal::Course, course_deg), at(20.0)];
        found = last(&drive.on(0.2, &readings)).yaw_rate_radps.get();
        distance_m += 4.0;
        if found.unwrap() < 0.0 {
            break;
        }
    }
    assert!((20.0..80.0).contains(&distance_m), "{distance_m}");
}

#[test]
fn a_course_needs_speed() {
    let mut drive = ReadingsDrive::of(by_force());
    let readings = |mps: f32| [FORCE, (Signal::Course, 45.0), at(mps)];
    drive.on(4.0, &readings(2.5));
    let fast = last(&drive.on(8.0, &readings(2.5)));
    assert_eq!(fast.course_deg.get(), Some(45.0));
    assert_eq!(fast.yaw_rate_radps.get(), Some(0.0));
    drive.on(4.0, &readings(1.5));
    let slow = last(&drive.on(8.0, &readings(1.5)));
    assert_eq!(slow.course_deg.get(), None);
    assert_eq!(slow.yaw_rate_radps.get(), None);
}

#[test]
fn time_in_motion_ends_with_a_long_stop() {
    let mut drive = ReadingsDrive::of(by_force());
    let driven = |drive: &mut ReadingsDrive, seconds: f64| {
        last(&drive.on(seconds, &[FORCE, at(20.0)])).driven_s
    };
    assert!((driven(&mut drive, 100.0) - 100.0).abs() < 1.0);
    // A stop of a minute is not counted and does not reset it. A gap in the traffic is counted and
    // does not reset it either.
    drive.on(60.0, &[FORCE, at(0.0)]);
    assert!((driven(&mut drive, 50.0) - 150.0).abs() < 1.0);
    drive.now_ms += 20_000;
    assert!((driven(&mut drive, 10.0) - 180.0).abs() < 1.0);
    // A change between standstill and motion counts after a second.
    drive.on(602.0, &[FORCE, at(0.0)]);
    assert!((driven(&mut drive, 30.0) - 29.0).abs() < 1.0);
    drive.now_ms += 601_000;
    assert!((driven(&mut drive, 20.0) - 20.0).abs() < 1.0);
}

#[test]
fn torque_arrives_through_a_gear() {
    let mut drive = ReadingsDrive::of(truck());
    let readings = |gear: f32, engaged: f32| {
        [
            (Signal::DrivelineEngaged, engaged),
            (Signal::CurrentGear, gear),
            (Signal::EngineTorque, 30.0),
            at(20.0),
        ]
    };
    assert!(last(&drive.on(2.0, &readings(12.0, 1.0))).engaged);
    assert!(!last(&drive.on(2.0, &readings(12.0, 0.0))).engaged);
    assert!(!last(&drive.on(2.0, &readings(0.0, 1.0))).engaged);
}
