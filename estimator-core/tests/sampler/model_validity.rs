//! Where the vehicle model is valid: readings in, samples out.

use estimator_core::sample::Sample;
use estimator_core::signal::encode;
use estimator_core::{Context, Instant, Intake, Reading, Sampler, Signal, Tuning, Value};
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{TestFrame, truck};

/// A direct gear (truck()'s eleventh) at 20 m/s turns the engine at this, rpm.
const RPM: f32 = 1_115.4;

/// Returns readings of 20 m/s in the direct gear with half the torque, after the given ones.
fn cruising(more: &[(Signal, f32)]) -> Vec<(Signal, f32)> {
    let mut readings = vec![(Signal::FrictionTorque, 7.0), (Signal::EngineSpeed, RPM)];
    readings.extend_from_slice(more);
    for own in [
        (Signal::CurrentGear, 11.0),
        (Signal::EngineTorque, 57.0),
        (Signal::WheelSpeed, 20.0),
    ] {
        if !more.iter().any(|reading| reading.0 == own.0) {
            readings.push(own);
        }
    }
    readings
}

fn valid(samples: &[Sample]) -> usize {
    samples
        .iter()
        .filter(|sample| sample.end.condition.is_valid())
        .count()
}

/// Returns the time in `samples` until the model is valid again, s.
fn seconds_invalid(samples: &[Sample]) -> f64 {
    let begin = samples[0].end.time;
    samples
        .iter()
        .rev()
        .find(|sample| !sample.end.condition.is_valid())
        .map_or(0.0, |sample| {
            sample.end.time.since(begin).micros() as f64 * 1e-6
        })
}

fn is_between(found: f64, low: f64, high: f64) {
    assert!((low..=high).contains(&found), "{found}: {low} to {high}");
}

#[test]
fn each_brake_has_a_hold_time() {
    for (signal, on, off) in [
        (Signal::BrakeSwitch, 1.0, 0.0),
        (Signal::BrakeLight, 1.0, 0.0),
        (Signal::FoundationBrake, 1.0, 0.0),
        (Signal::BrakePedal, 12.0, 0.0),
        (Signal::BrakePressure, 80_000.0, 0.0),
        (Signal::ParkingBrake, 1.0, 0.0),
        (Signal::RetarderTorque, -20.0, 0.0),
        (Signal::RetarderForce, 5_000.0, 0.0),
        (Signal::RetarderForce, -5_000.0, 200.0),
    ] {
        let mut drive = ReadingsDrive::of(truck());
        let before = drive.on(5.0, &cruising(&[(signal, off)]));
        assert_eq!(valid(&before), before.len(), "{signal:?}");
        let during = drive.on(3.0, &cruising(&[(signal, on)]));
        // Only the cell in which the brake came on.
        assert!(valid(&during) <= 1, "{signal:?}");
        assert!(during.last().unwrap().end.condition.braking);
        let after = drive.on(6.0, &cruising(&[(signal, off)]));
        is_between(seconds_invalid(&after), 0.25, 0.75);
    }
}

#[test]
fn a_brake_light_counts_beside_a_switch_that_is_off_and_the_other_way_round() {
    for (switch, light) in [(0.0, 1.0), (1.0, 0.0)] {
        let mut drive = ReadingsDrive::of(truck());
        let readings = [(Signal::BrakeSwitch, switch), (Signal::BrakeLight, light)];
        let samples = drive.on(10.0, &cruising(&readings));
        let is_braking = |sample: &Sample| sample.end.condition.braking;
        assert!(samples[1..].iter().all(is_braking), "{switch} {light}");
    }
}

#[test]
fn a_retarder_at_rest_drags_a_percent_and_is_no_brake() {
    let mut drive = ReadingsDrive::of(truck());
    let samples = drive.on(10.0, &cruising(&[(Signal::RetarderTorque, -1.0)]));
    assert_eq!(valid(&samples), samples.len());
}

#[test]
fn either_of_two_retarders_counts() {
    let mut context = Context::new(truck(), Tuning::default()).unwrap();
    let mut intake = Intake::new(&context.tuning);
    let mut sampler = Sampler::new();
    let mut braking = Vec::new();
    let frame = |source, percent| {
        let mut payload = [0; 8];
        encode(61_440, &mut payload, |signal| match signal {
            Signal::RetarderTorque => Value::Real(percent),
            _ => Value::NotAvailable,
        });
        TestFrame::of_pgn(61_440, source, &payload)
    };
    for k in 0..100 {
        let now = Instant::from_micros(k * 100_000);
        // The engine's retarder sends first and last; the gearbox's brakes from 5 s on.
        for (source, percent) in [
            (0x0f, 0.0),
            (0x10, if k < 50 { 0.0 } else { -30.0 }),
            (0x0f, 0.0),
        ] {
            intake.on_frame(&mut context, now, &frame(source, percent), &mut sampler);
        }
        for (signal, value) in cruising(&[]) {
            let value = Value::Real(value);
            let reading = Reading { signal, value };
            intake.on_reading(&mut context, now, reading, &mut sampler);
        }
        while let Some(sample) = sampler.next_sample() {
            braking.push((k, sample.end.condition.braking));
        }
    }
    for (k, braking) in braking {
        assert_eq!(braking, k >= 50, "{k}");
    }
}

#[test]
fn a_brake_whose_sender_falls_silent_counts_for_seconds_not_for_ever() {
    for nothing in [None, Some(Value::NotAvailable), Some(Value::Error)] {
        let mut drive = ReadingsDrive::of(truck());
        drive.on(5.0, &cruising(&[(Signal::BrakeSwitch, 1.0)]));
        let mut readings: Vec<(Signal, Value)> = nothing
            .map(|value| (Signal::BrakeSwitch, value))
            .into_iter()
            .collect();
        readings.extend(
            cruising(&[])
                .into_iter()
                .map(|(signal, value)| (signal, Value::Real(value))),
        );
        let after = drive.on_values(15.0, &readings);
        // 5 s until the last reading is stale, then the hold time.
        is_between(seconds_invalid(&after), 5.1, 5.7);
    }
}

#[test]
fn a_gear_shift_holds_and_passes_no_torque_where_the_driveline_is_not_reported() {
    let mut drive = ReadingsDrive::of(truck());
    let flag = |on: f32| cruising(&[(Signal::ShiftInProcess, on)]);
    let before = drive.on(5.0, &flag(0.0));
    assert!(before.last().unwrap().forces.traction_n > 4_000.0);
    let during = drive.on(1.0, &flag(1.0));
    assert!(during.last().unwrap().end.condition.shifting);
    assert_eq!(during.last().unwrap().forces.traction_n, 0.0);
    let after = drive.on(5.0, &flag(0.0));
    is_between(seconds_invalid(&after), 0.25, 0.75);
    assert!(after.last().unwrap().forces.traction_n > 4_000.0);
}

#[test]
fn an_open_driveline_coasts_without_traction_and_the_model_holds() {
    let mut drive = ReadingsDrive::of(truck());
    let closed = drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 1.0)]));
    assert_eq!(valid(&closed), closed.len());
    // Idling: the torque equals that of friction.
    let idle = [
        (Signal::EngineSpeed, 600.0),
        (Signal::DrivelineEngaged, 0.0),
        (Signal::EngineTorque, 7.0),
    ];
    let open = drive.on(10.0, &cruising(&idle));
    is_between(seconds_invalid(&open), 0.25, 0.75);
    assert_eq!(open.last().unwrap().forces.traction_n, 0.0);
    let closed = drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 1.0)]));
    is_between(seconds_invalid(&closed), 0.25, 0.75);
    assert!(closed.last().unwrap().forces.traction_n > 4_000.0);
}

#[test]
fn the_model_holds_in_neutral_as_behind_any_open_driveline() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &cruising(&[]));
    let idle = [
        (Signal::EngineSpeed, 600.0),
        (Signal::CurrentGear, 0.0),
        (Signal::EngineTorque, 7.0),
    ];
    let neutral = drive.on(10.0, &cruising(&idle));
    is_between(seconds_invalid(&neutral), 0.0, 1.25);
    assert_eq!(neutral.last().unwrap().forces.traction_n, 0.0);
}

#[test]
fn no_engine_torque_counts_behind_an_open_driveline() {
    let open: [&[(Signal, f32)]; 6] = [
        &[(Signal::DrivelineEngaged, 0.0)],
        &[(Signal::ClutchSwitch, 1.0)],
        &[(Signal::DrivelineEngaged, 1.0), (Signal::ClutchSwitch, 1.0)],
        &[(Signal::ClutchSlip, 100.0)],
        &[(Signal::DrivelineEngaged, 0.0), (Signal::ClutchSlip, 100.0)],
        &[(Signal::CurrentGear, 0.0)],
    ];
    for signals in open {
        let mut drive = ReadingsDrive::of(truck());
        drive.on(5.0, &cruising(&[]));
        let samples = drive.on(5.0, &cruising(signals));
        for sample in &samples[1..] {
            assert!(sample.forces.traction_n.abs() < 1e-3, "{signals:?}");
            // The engine has half its torque: the clutch may pass it after all.
            assert!(!sample.end.condition.is_valid(), "{signals:?}");
        }
    }
}

#[test]
fn a_slipping_clutch_is_not_trusted() {
    let mut drive = ReadingsDrive::of(truck());
    let engaged = (Signal::DrivelineEngaged, 1.0);
    drive.on(5.0, &cruising(&[engaged, (Signal::ClutchSlip, 0.0)]));
    let slipping = drive.on(3.0, &cruising(&[engaged, (Signal::ClutchSlip, 30.0)]));
    assert!(valid(&slipping) <= 1);
    let closed = drive.on(5.0, &cruising(&[engaged, (Signal::ClutchSlip, 2.0)]));
    is_between(seconds_invalid(&closed), 0.25, 0.75);
}

#[test]
fn an_open_driveline_whose_sender_has_no_measurement_stays_open_until_that_is_stale() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 0.0)]));
    let mut readings = vec![(Signal::DrivelineEngaged, Value::Error)];
    readings.extend(
        cruising(&[])
            .into_iter()
            .map(|(signal, value)| (signal, Value::Real(value))),
    );
    let after = drive.on_values(10.0, &readings);
    let begin = after[0].end.time;
    let closes = after
        .iter()
        .find(|sample| sample.forces.traction_n > 1_000.0)
        .unwrap();
    let seconds = closes.end.time.since(begin).micros() as f64 * 1e-6;
    is_between(seconds, 4.5, 5.3);
}

/// Returns the readings with the engine at this speed.
fn at_rpm(readings: &[(Signal, f32)], rpm: f32) -> Vec<(Signal, f32)> {
    let mut readings = readings.to_vec();
    for (signal, value) in &mut readings {
        if *signal == Signal::EngineSpeed {
            *value = rpm;
        }
    }
    readings
}

#[test]
fn a_gear_that_the_engine_does_not_turn_with_is_rejected() {
    // No signal reports the clutch: the gear stays what it was while the engine runs faster.
    let mut drive = ReadingsDrive::of(truck());
    let closed = drive.on(5.0, &cruising(&[]));
    assert_eq!(valid(&closed), closed.len());
    let away = at_rpm(&cruising(&[]), 1.3 * RPM);
    let open = drive.on(1.9, &away);
    assert!(valid(&open) <= 1);
    for sample in &open[1..] {
        assert!(sample.forces.traction_n.abs() < 1e-3);
    }
    // A gearbox that reports its clutch is accepted.
    let mut drive = ReadingsDrive::of(truck());
    let away = cruising(&[(Signal::DrivelineEngaged, 1.0)]);
    let away = at_rpm(&away, 1.3 * RPM);
    let reported = drive.on(5.0, &away);
    assert_eq!(valid(&reported), reported.len());
    // Unless the engine turned with the reported gear before.
    let mut drive = ReadingsDrive::of(truck());
    let before = drive.on(100.0, &at_rpm(&away, RPM));
    assert_eq!(valid(&before), before.len());
    let after = drive.on(1.9, &away);
    assert_eq!(valid(&after[1..]), 0);
}

#[test]
fn a_gearbox_that_falls_silent_leaves_no_traction() {
    let mut drive = ReadingsDrive::of(truck());
    drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 0.0)]));
    let torque_only = [(Signal::EngineTorque, 57.0), (Signal::WheelSpeed, 20.0)];
    let samples = drive.on(12.0, &torque_only);
    let last = samples.last().unwrap();
    assert!(last.end.condition.no_traction, "{last:?}");
    assert_eq!(last.forces.traction_n, 0.0);
}

#[test]
fn signals_that_tell_nothing_of_the_motion_change_no_sample() {
    let driven = |more: &[(Signal, f32)]| {
        let mut drive = ReadingsDrive::of(truck());
        drive.on(10.0, &cruising(more))
    };
    let unread = [
        Signal::RetarderReferenceTorque,
        Signal::RoadwayGrade,
        Signal::EngineTorqueMode,
        Signal::ParasiticTorque,
        Signal::OutputShaftSpeed,
        Signal::SelectedGear,
        Signal::Passengers,
        Signal::PitchRate,
    ];
    assert_eq!(driven(&unread.map(|signal| (signal, 3.0))), driven(&[]));
}

#[test]
fn a_gear_ratio_says_nothing_of_a_vehicle_that_is_known_by_its_force() {
    let driven = |ratio: Option<f32>| {
        let mut drive = ReadingsDrive::of(test_kit::by_force());
        let ratio = ratio.map(|ratio| (Signal::GearRatio, ratio));
        let rest = [(Signal::TractionForce, 4_000.0), (Signal::WheelSpeed, 20.0)];
        let readings: Vec<_> = ratio.into_iter().chain(rest).collect();
        drive.on(10.0, &readings)
    };
    assert_eq!(driven(Some(1.0)), driven(None));
}
