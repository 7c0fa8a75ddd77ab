//! GNSS altitudes that are wrong: outliers, steps, drifts, silence, other sources, a stuck receiver.

use estimator_core::filter::{AltitudeEvent, ModelMass};
use estimator_core::sample::{AltitudeContinuity, Sample};
use estimator_core::{Counters, Signal, Tuning};
use test_kit::by_force;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{FilterRun, FilteredStep, Noise, altitude, sample, smooth, speed, truck};

/// Simulates a level drive. `fault` returns the error of the fix in a cell, m.
fn level_drive(fault: impl Fn(u32) -> f32) -> (Vec<FilteredStep<f64>>, Counters) {
    drive_with_fixes(4_000, |k, altitude_m| Some(altitude_m + fault(k)))
}

/// Simulates the same drive with the fixes that `fix` returns for a cell and its true altitude.
fn drive_with_fixes(
    length: u32,
    fix: impl Fn(u32, f32) -> Option<f32>,
) -> (Vec<FilteredStep<f64>>, Counters) {
    changed_drive(length, fix, |_, _| ())
}

/// Simulates the same drive with samples that `change` changes.
fn changed_drive(
    length: u32,
    fix: impl Fn(u32, f32) -> Option<f32>,
    change: impl Fn(u32, &mut Sample),
) -> (Vec<FilteredStep<f64>>, Counters) {
    tuned_drive(Tuning::default(), length, fix, change)
}

/// Simulates the same drive with another tuning.
pub(super) fn tuned_drive(
    tuning: Tuning,
    length: u32,
    fix: impl Fn(u32, f32) -> Option<f32>,
    change: impl Fn(u32, &mut Sample),
) -> (Vec<FilteredStep<f64>>, Counters) {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * 400.0;
    let force_n = air_n + weight_n * vehicle.rolling_resistance;
    let mut run = FilterRun::new(vehicle, tuning);
    let mut noise = Noise(3);
    let cells = (1..=length)
        .map(|k| {
            let mut s = sample(k, force_n, 20.0);
            // The file is right, so that only the receiver can be wrong.
            s.mass_is_reported = true;
            s.speed = speed(20.0 + 0.013 * noise.draw());
            if k % 8 == 0 {
                s.altitude = fix(k, 100.0 + 0.3 * noise.draw()).and_then(altitude);
            }
            change(k, &mut s);
            run.step(&s).expect("every sample has a speed")
        })
        .collect();
    (cells, run.context.counters)
}

fn worst_grade(cells: &[FilteredStep<f64>]) -> f32 {
    let late = &smooth(cells)[400..];
    late.iter()
        .map(|e| e.grade_percent.value.abs())
        .fold(0.0, f32::max)
}

#[test]
fn a_single_wild_altitude_is_rejected() {
    let (clean, _) = level_drive(|_| 0.0);
    let (cells, counters) = level_drive(|k| if k % 400 == 0 { 40.0 } else { 0.0 });
    assert_eq!(counters.altitudes_rejected, 10);
    assert_eq!(counters.altitude_resets, 1, "the first fix only");
    assert!(worst_grade(&cells) < worst_grade(&clean) + 0.02);
}

#[test]
fn a_step_of_the_receiver_moves_neither_slope_nor_altitude() {
    let (clean, _) = level_drive(|_| 0.0);
    let (cells, counters) = level_drive(|k| {
        if (1_500..2_000).contains(&k) {
            25.0
        } else {
            0.0
        }
    });
    assert_eq!(counters.altitude_resets, 1, "the first fix");
    // The step back is within its variance once the error is known to be large.
    assert!((1..=2).contains(&counters.altitude_steps));
    assert!(counters.altitudes_rejected < 10);
    assert!(worst_grade(&cells) < worst_grade(&clean) + 0.02);
    let altitude = |k: usize| {
        cells[k]
            .state
            .estimate(&ModelMass::default())
            .altitude_m
            .unwrap()
            .value
    };
    assert!((altitude(1_700) - altitude(1_400)).abs() < 3.0);
    assert!((altitude(2_300) - altitude(1_400)).abs() < 3.0);
}

#[test]
fn a_noisy_receiver_is_learned_and_its_fixes_are_used() {
    let mut noise = Noise(5);
    let draws: Vec<f32> = (0..=4_000).map(|_| 3.0 * noise.draw()).collect();
    let (cells, counters) = level_drive(|k| draws[k as usize]);
    // Of 500 fixes. A gate that did not learn would reject most of them.
    assert!(
        counters.altitudes_rejected < 40,
        "{}",
        counters.altitudes_rejected
    );
    assert!(worst_grade(&cells) < 0.25, "{}", worst_grade(&cells));
}

/// Returns an error that grows by 1 m per 100 m between two cells, and is constant elsewhere.
fn ramp(from: u32, to: u32, sign: f32) -> impl Fn(u32) -> f32 {
    move |k| sign * 0.025 * (k.clamp(from, to) - from) as f32
}

fn events(cells: &[FilteredStep<f64>]) -> Vec<(u32, AltitudeEvent)> {
    let events = cells
        .iter()
        .filter_map(|cell| Some((cell.record.end.cell, cell.record.event?)));
    events
        .filter(|(_, event)| *event != AltitudeEvent::Outlier)
        .collect()
}

#[test]
fn a_drift_is_detected_and_rejected_until_it_ends() {
    for sign in [1.0, -1.0] {
        let (cells, counters) = level_drive(ramp(1_500, 1_900, sign));
        assert_eq!(counters.altitude_drifts, 1);
        assert_eq!(counters.altitude_drifts_believed, 0);
        let events = events(&cells);
        let [
            (1..=8, AltitudeEvent::SetAnew),
            (found, AltitudeEvent::DriftBegan(since)),
            (ended, AltitudeEvent::DriftEnded(same)),
        ] = events[..]
        else {
            panic!("{events:?}");
        };
        assert_eq!(since, same);
        // Found within half a kilometre, with its start. It ends once climbs agree over 300 m.
        assert!((1_540..1_700).contains(&found), "{found}");
        assert!((1_420..1_560).contains(&since), "{since}");
        assert!((1_900..2_100).contains(&ended), "{ended}");
        assert!(counters.altitudes_rejected > 20);
        // The receiver stays 10 m off, and the altitude does not follow it.
        let after = cells[2_200]
            .state
            .estimate(&ModelMass::default())
            .altitude_m
            .unwrap();
        assert!((after.value - 100.0).abs() < 6.0, "{after:?}");
    }
}

/// A road that climbs by 3 % over a kilometre, from cell 1,500 on, with the force of a level road.
fn unseen_climb(rests: impl Fn(u32) -> bool) -> (Vec<FilteredStep<f64>>, Counters) {
    changed_drive(
        4_000,
        |k, altitude_m| Some(altitude_m + 3.0 * ramp(1_500, 1_900, 1.0)(k)),
        |k, sample| {
            sample.torque_rests = rests(k);
            sample.effect_inputs.engaged = true;
        },
    )
}

#[test]
fn a_torque_that_rests_where_altitudes_leave_its_climb_is_stuck_until_it_changes() {
    let (cells, counters) = unseen_climb(|k| (1_480..1_900).contains(&k));
    let events = events(&cells);
    let [
        (1..=8, AltitudeEvent::SetAnew),
        (found, AltitudeEvent::TorqueStuck { cells: since }),
    ] = events[..]
    else {
        panic!("{events:?}");
    };
    assert!((1_510..1_600).contains(&found), "{found}");
    assert!((1_480..1_520).contains(&(found - since)), "{since}");
    assert_eq!(
        (counters.altitude_drifts, counters.climbs_contradicted),
        (0, 1)
    );
    let at = |cell: u32| &cells[cell as usize - 1];
    assert!(at(found).record.disagreement.torque);
    assert_eq!(at(found).record.disagreeing_cells, since);
    for cell in 1_400..2_000 {
        let is_known = !at(cell).record.end.condition.no_traction;
        assert_eq!(is_known, cell <= found || cell >= 1_900, "{cell}");
    }
    // The altitudes show the climb while the torque is not used.
    for cell in (found + 100)..1_900 {
        let grade = at(cell).state.estimate(&ModelMass::default()).grade_percent;
        assert!(
            (grade.value - 3.0).abs() < 3.0 * grade.sigma,
            "{cell}: {grade:?}"
        );
        assert!(grade.sigma < 1.5, "{cell}: {grade:?}");
    }
}

#[test]
fn the_torque_of_an_open_driveline_is_not_stuck() {
    let (cells, counters) = changed_drive(
        4_000,
        |k, altitude_m| Some(altitude_m + ramp(1_500, 1_900, 1.0)(k)),
        |k, sample| {
            sample.torque_rests = true;
            sample.effect_inputs.engaged = k < 1_400;
        },
    );
    assert_eq!(
        (counters.altitude_drifts, counters.climbs_contradicted),
        (1, 0)
    );
    assert!(
        cells
            .iter()
            .all(|cell| !cell.record.end.condition.no_traction)
    );
}

#[test]
fn a_torque_that_moves_is_not_stuck() {
    let (cells, counters) = unseen_climb(|k| k % 20 != 0);
    assert!(counters.altitude_drifts > 0);
    let is_stuck =
        |(_, event): &(u32, AltitudeEvent)| matches!(event, AltitudeEvent::TorqueStuck { .. });
    assert!(!events(&cells).iter().any(is_stuck));
}

#[test]
fn a_stop_in_a_drift_does_not_end_it() {
    let drift = ramp(1_500, 1_900, 1.0);
    let (cells, counters) = changed_drive(
        4_000,
        |k, altitude_m| Some(altitude_m + drift(k)),
        |k, sample| sample.after_stop = k == 1_800,
    );
    assert_eq!(counters.altitude_drifts, 1);
    let events = events(&cells);
    let [(_, AltitudeEvent::SetAnew), (found, _), (ended, last)] = events[..] else {
        panic!("{events:?}");
    };
    assert!(found < 1_700 && (1_900..2_150).contains(&ended));
    assert!(matches!(last, AltitudeEvent::DriftEnded(_)), "{last:?}");
    assert!(worst_grade(&cells) < 0.25, "{}", worst_grade(&cells));
}

#[test]
fn a_receiver_that_drifted_while_the_vehicle_stood_moves_its_datum_only() {
    let jump_m = |k: u32| if k < 1_000 { 0.0 } else { 12.0 };
    let (cells, counters) = changed_drive(
        2_000,
        |k, altitude_m| Some(altitude_m + jump_m(k)),
        |k, sample| {
            if let Some(altitude) = sample.altitude.as_mut().filter(|_| k == 1_000) {
                altitude.continuity = AltitudeContinuity::Drifted;
            }
        },
    );
    assert_eq!((counters.altitude_resets, counters.altitude_steps), (1, 0));
    assert_eq!(counters.altitudes_rejected, 0);
    assert_eq!(events(&cells).len(), 1, "the first fix only");
    unmoved(&cells[995], &cells[1_010]);
    let estimate = cells[1_990].state.estimate(&ModelMass::default());
    let altitude_m = estimate.altitude_m.unwrap().value;
    assert!((altitude_m - 100.0).abs() < 4.0, "{altitude_m}");
}

#[test]
fn a_drift_that_falls_back_ends_too() {
    let (cells, counters) = level_drive(|k| {
        if k < 1_900 {
            ramp(1_500, 1_900, 1.0)(k)
        } else {
            0.0
        }
    });
    assert_eq!(counters.altitude_drifts, 1);
    let ended = events(&cells)
        .into_iter()
        .find_map(|(cell, event)| matches!(event, AltitudeEvent::DriftEnded(_)).then_some(cell));
    assert!((1_900..2_100).contains(&ended.unwrap()), "{ended:?}");
}

#[test]
fn a_climb_that_never_ends_is_accepted_in_the_end() {
    // A road of 3 % that the model reads as level: the model is off.
    let (cells, counters) = level_drive(|k| 3.0 * ramp(800, 4_000, 1.0)(k));
    assert!(
        counters.altitude_drifts_believed >= 1,
        "{:?}",
        events(&cells)
    );
    let grade = cells
        .last()
        .unwrap()
        .state
        .estimate(&ModelMass::default())
        .grade_percent;
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

/// Checks that a change of the datum moved neither slope nor slow states.
fn unmoved(before: &FilteredStep<f64>, after: &FilteredStep<f64>) {
    let [before, after] = [before, after].map(|cell| cell.state.estimate(&ModelMass::default()));
    for (a, b, within) in [
        (before.grade_percent, after.grade_percent, 0.2),
        (before.bias_percent, after.bias_percent, 0.03),
        (before.scale, after.scale, 0.01),
    ] {
        assert!((a.value - b.value).abs() < within, "{a:?} {b:?}");
    }
}

#[test]
fn another_source_or_a_long_silence_resets_the_altitude_and_nothing_else() {
    // 937 s at 20 m/s: longer than the 900 s that are bridged.
    let silence = |k: u32, altitude_m: f32| {
        (!(800..8_300).contains(&k)).then_some(altitude_m + if k < 800 { 0.0 } else { 35.0 })
    };
    let (cells, counters) = drive_with_fixes(9_000, silence);
    assert_eq!(counters.altitude_resets, 2);
    assert_eq!(counters.altitude_steps, 0);
    unmoved(&cells[8_290], &cells[8_320]);
    let height = |k: usize| {
        cells[k]
            .state
            .estimate(&ModelMass::default())
            .altitude_m
            .unwrap()
            .value
    };
    assert!((height(8_320) - 135.0).abs() < 4.0, "{}", height(8_320));

    let short = |k: u32, altitude_m: f32| (!(800..3_300).contains(&k)).then_some(altitude_m);
    assert_eq!(
        drive_with_fixes(4_000, short).1.altitude_resets,
        1,
        "312 s are bridged"
    );

    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let mut run = FilterRun::new(vehicle, Tuning::default());
    let mut cells = Vec::new();
    for k in 1..=2_000_u32 {
        let mut s = sample(k, 0.01 * weight_n, 20.0);
        s.speed = speed(20.0);
        if k % 8 == 0 {
            s.altitude = altitude(if k < 1_000 { 100.0 } else { 130.0 });
        }
        if k == 1_000 {
            s.altitude.as_mut().unwrap().continuity = AltitudeContinuity::Switched;
        }
        cells.extend(run.step(&s));
    }
    let counters = run.context.counters;
    assert_eq!((counters.altitude_resets, counters.altitude_steps), (2, 0));
    unmoved(&cells[995], &cells[1_010]);
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
    let mut drive = ReadingsDrive::of(by_force());
    for k in 0..20 {
        drive.on(1.0, &moving(100.0 + 0.1 * k as f32));
    }
    assert_eq!(drive.context.counters.frozen_fixes, 0);
    let stuck = drive.on(30.0, &moving(103.0));
    let used = stuck.iter().filter(|sample| sample.altitude.is_some());
    assert!(used.count() < 45, "the first 100 m");
    assert!(drive.context.counters.frozen_fixes > 200);
    let free = drive.on(1.0, &moving(103.1));
    assert!(free.iter().any(|sample| sample.altitude.is_some()));

    let standing = [(Signal::Altitude, 80.0), (Signal::WheelSpeed, 0.0)];
    let frozen = drive.context.counters.frozen_fixes;
    drive.on(60.0, &standing);
    assert_eq!(drive.context.counters.frozen_fixes, frozen, "it stands");

    let dilution = |more: &[(Signal, f32)]| {
        let mut drive = ReadingsDrive::of(by_force());
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
