//! GNSS altitudes that are wrong: outliers, steps, drifts, silence, other sources, a stuck receiver.

use estimator_core::filter::{AltitudeEvent, Filter, Record};
use estimator_core::sampler::Continuity;
use estimator_core::{Counters, Signal, Tuning};
use test_kit::by_force;
use test_kit::readings_drive::Drive;
use test_kit::{Noise, altitude, sample, smooth, speed, truck};

/// A level drive with good altitudes but for `fault`, which tells what a fix is off by.
fn level_drive(fault: impl Fn(u32) -> f32) -> (Vec<Record<f64>>, Counters) {
    drive_with_fixes(|k, altitude_m| Some(altitude_m + fault(k)))
}

/// The same with fixes as `fix` has them, which is given the right altitude.
fn drive_with_fixes(fix: impl Fn(u32, f32) -> Option<f32>) -> (Vec<Record<f64>>, Counters) {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * 400.0;
    let force_n = air_n + weight_n * vehicle.rolling_resistance;
    let mut filter = Filter::new();
    let mut counters = Counters::default();
    let mut noise = Noise(3);
    let records = (1..=4_000_u32)
        .map(|k| {
            let mut s = sample(k, force_n, 20.0);
            s.speed = speed(20.0 + 0.013 * noise.draw());
            if k % 8 == 0 {
                s.altitude = fix(k, 100.0 + 0.3 * noise.draw()).and_then(altitude);
            }
            let step = filter.step(&vehicle, &Tuning::default(), &s, &mut counters);
            step.expect("every sample has a speed")
        })
        .collect();
    (records, counters)
}

fn worst_grade(records: &[Record<f64>]) -> f32 {
    let late = &smooth(records)[400..];
    late.iter()
        .map(|e| e.grade_percent.value.abs())
        .fold(0.0, f32::max)
}

#[test]
fn a_single_wild_altitude_is_left_out() {
    let (clean, _) = level_drive(|_| 0.0);
    let (records, counters) = level_drive(|k| if k % 400 == 0 { 40.0 } else { 0.0 });
    assert_eq!(counters.altitudes_rejected, 10);
    assert_eq!(counters.altitude_resets, 1, "the first fix only");
    assert!(worst_grade(&records) < worst_grade(&clean) + 0.02);
}

#[test]
fn a_step_of_the_receiver_moves_neither_slope_nor_altitude() {
    let (clean, _) = level_drive(|_| 0.0);
    let (records, counters) = level_drive(|k| {
        if (1_500..2_000).contains(&k) {
            25.0
        } else {
            0.0
        }
    });
    assert_eq!(counters.altitude_resets, 1, "the first fix");
    // The way back is no surprise once the error is known to be large.
    assert!((1..=2).contains(&counters.altitude_steps));
    assert!(counters.altitudes_rejected < 10);
    assert!(worst_grade(&records) < worst_grade(&clean) + 0.02);
    let altitude = |k: usize| records[k].state.estimate().altitude_m.unwrap().value;
    assert!((altitude(1_700) - altitude(1_400)).abs() < 3.0);
    assert!((altitude(2_300) - altitude(1_400)).abs() < 3.0);
}

#[test]
fn a_noisy_receiver_is_learned_and_not_picked_from() {
    let mut noise = Noise(5);
    let draws: Vec<f32> = (0..=4_000).map(|_| 3.0 * noise.draw()).collect();
    let (records, counters) = level_drive(|k| draws[k as usize]);
    // Of 500 fixes; a gate that did not learn would leave out most.
    assert!(
        counters.altitudes_rejected < 40,
        "{}",
        counters.altitudes_rejected
    );
    assert!(worst_grade(&records) < 0.25, "{}", worst_grade(&records));
}

/// An error that grows by 1 m per 100 m between two cells and stays what it is.
fn ramp(from: u32, to: u32, sign: f32) -> impl Fn(u32) -> f32 {
    move |k| sign * 0.025 * (k.clamp(from, to) - from) as f32
}

fn events(records: &[Record<f64>]) -> Vec<(u32, AltitudeEvent)> {
    let told = records
        .iter()
        .filter_map(|r| Some((r.place.cell, r.event?)));
    told.filter(|(_, event)| *event != AltitudeEvent::Outlier)
        .collect()
}

#[test]
fn a_drift_is_noticed_and_left_out_until_it_ends() {
    for sign in [1.0, -1.0] {
        let (records, counters) = level_drive(ramp(1_500, 1_900, sign));
        assert_eq!(counters.altitude_drifts, 1);
        assert_eq!(counters.altitude_drifts_believed, 0);
        let events = events(&records);
        let [
            (1..=8, AltitudeEvent::SetAnew),
            (found, AltitudeEvent::DriftBegan(since)),
            (ended, AltitudeEvent::DriftEnded(same)),
        ] = events[..]
        else {
            panic!("{events:?}");
        };
        assert_eq!(since, same);
        // Within half a kilometre, and told whence; ended once 300 m have climbed as they should.
        assert!((1_540..1_700).contains(&found), "{found}");
        assert!((1_420..1_560).contains(&since), "{since}");
        assert!((1_900..2_100).contains(&ended), "{ended}");
        assert!(counters.altitudes_rejected > 20);
        // The receiver stays 10 m off, and the altitude does not follow it.
        let after = records[2_200].state.estimate().altitude_m.unwrap();
        assert!((after.value - 100.0).abs() < 6.0, "{after:?}");
    }
}

#[test]
fn a_drift_that_falls_back_is_over_too() {
    let (records, counters) = level_drive(|k| {
        if k < 1_900 {
            ramp(1_500, 1_900, 1.0)(k)
        } else {
            0.0
        }
    });
    assert_eq!(counters.altitude_drifts, 1);
    let ended = events(&records)
        .into_iter()
        .find_map(|(cell, event)| matches!(event, AltitudeEvent::DriftEnded(_)).then_some(cell));
    assert!((1_900..2_100).contains(&ended.unwrap()), "{ended:?}");
}

#[test]
fn a_climb_that_never_ends_is_believed_in_the_end() {
    // A road of 3 % that the model reads as level: it is the model that is off.
    let (records, counters) = level_drive(|k| 3.0 * ramp(800, 4_000, 1.0)(k));
    assert!(
        counters.altitude_drifts_believed >= 1,
        "{:?}",
        events(&records)
    );
    let grade = records.last().unwrap().state.estimate().grade_percent;
    assert!((grade.value - 3.0).abs() < 3.0 * grade.sigma, "{grade:?}");
    assert!((grade.value - 3.0).abs() < 0.4, "{grade:?}");
}

#[test]
fn good_fixes_are_no_drift() {
    for noise in [0.0, 1.0, 3.0] {
        let mut draw = Noise(11);
        let draws: Vec<f32> = (0..=4_000).map(|_| noise * draw.draw()).collect();
        let (_, counters) = level_drive(|k| draws[k as usize]);
        assert_eq!(counters.altitude_drifts, 0, "{noise} m");
    }
}

/// Slow states and slope, which no change of the datum may move.
fn unmoved(before: &Record<f64>, after: &Record<f64>) {
    let [before, after] = [before, after].map(|record| record.state.estimate());
    for (a, b, within) in [
        (before.grade_percent, after.grade_percent, 0.2),
        (before.bias_percent, after.bias_percent, 0.03),
        (before.scale, after.scale, 0.01),
    ] {
        assert!((a.value - b.value).abs() < within, "{a:?} {b:?}");
    }
}

#[test]
fn another_source_or_a_long_silence_sets_the_altitude_anew_and_nothing_else() {
    // 50 km/h more than 300 s: 2,400 cells at 20 m/s.
    let silence = |k: u32, altitude_m: f32| {
        (!(800..3_300).contains(&k)).then_some(altitude_m + if k < 800 { 0.0 } else { 35.0 })
    };
    let (records, counters) = drive_with_fixes(silence);
    assert_eq!(counters.altitude_resets, 2);
    assert_eq!(counters.altitude_steps, 0);
    unmoved(&records[3_290], &records[3_320]);
    let height = |k: usize| records[k].state.estimate().altitude_m.unwrap().value;
    assert!((height(3_320) - 135.0).abs() < 4.0, "{}", height(3_320));

    let short = |k: u32, altitude_m: f32| (!(800..1_760).contains(&k)).then_some(altitude_m);
    assert_eq!(
        drive_with_fixes(short).1.altitude_resets,
        1,
        "120 s are bridged"
    );

    let vehicle = truck();
    let mut filter = Filter::<f64>::new();
    let mut counters = Counters::default();
    let mut records = Vec::new();
    for k in 1..=2_000_u32 {
        let mut s = sample(k, 0.01 * vehicle.mass_kg * 9.806_65, 20.0);
        s.speed = speed(20.0);
        if k % 8 == 0 {
            s.altitude = altitude(if k < 1_000 { 100.0 } else { 130.0 });
        }
        if k == 1_000 {
            s.altitude.as_mut().unwrap().continuity = Continuity::Switched;
        }
        records.extend(filter.step(&vehicle, &Tuning::default(), &s, &mut counters));
    }
    assert_eq!((counters.altitude_resets, counters.altitude_steps), (2, 0));
    unmoved(&records[995], &records[1_010]);
}

#[test]
fn a_stuck_receiver_is_not_used_and_few_satellites_count_less() {
    let moving = |altitude_m: f32| {
        vec![
            (Signal::TractionForce, 4_000.0),
            (Signal::Altitude, altitude_m),
            (Signal::WheelSpeed, 20.0),
        ]
    };
    let mut drive = Drive::of(by_force());
    for k in 0..20 {
        drive.on(1.0, &moving(100.0 + 0.1 * k as f32));
    }
    assert_eq!(drive.intake.counters().frozen_fixes, 0);
    let stuck = drive.on(30.0, &moving(103.0));
    let used = stuck.iter().filter(|sample| sample.altitude.is_some());
    assert!(used.count() < 45, "the first 100 m");
    assert!(drive.intake.counters().frozen_fixes > 200);
    let free = drive.on(1.0, &moving(103.1));
    assert!(free.iter().any(|sample| sample.altitude.is_some()));

    let standing = [(Signal::Altitude, 80.0), (Signal::WheelSpeed, 0.0)];
    let frozen = drive.intake.counters().frozen_fixes;
    drive.on(60.0, &standing);
    assert_eq!(drive.intake.counters().frozen_fixes, frozen, "it stands");

    let dilution = |more: &[(Signal, f32)]| {
        let mut drive = Drive::of(by_force());
        let mut readings = more.to_vec();
        readings.extend(moving(50.0));
        let samples = drive.on(2.0, &readings);
        let fix = samples.iter().find_map(|sample| sample.altitude);
        fix.unwrap().dilution
    };
    assert_eq!(dilution(&[]), 1.0);
    assert_eq!(dilution(&[(Signal::Satellites, 12.0)]), 1.0);
    assert_eq!(dilution(&[(Signal::Satellites, 4.0)]), 3.0);
    assert_eq!(
        dilution(&[(Signal::Satellites, 5.0), (Signal::Vdop, 6.0)]),
        6.0
    );
}
