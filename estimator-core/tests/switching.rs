//! When the vehicle model is trusted: readings in, samples out.

mod common;

use common::{TestFrame, altitude, sample, speed, truck};
use estimator_core::filter::Filter;
use estimator_core::filter::state::{BIAS, SCALE};
use estimator_core::sampler::Sample;
use estimator_core::signal::encode;
use estimator_core::{
    Counters, Instant, Intake, Reading, Signal, Traction, Tuning, Value, VehicleParameters,
};

/// A direct gear (truck()'s eleventh) at 20 m/s turns the engine at this, rpm.
const RPM: f32 = 1_115.4;

/// A drive by readings every 100 ms; the truck's own signals are sent each time, then the script's.
struct Drive {
    intake: Intake,
    now_ms: u64,
    samples: Vec<Sample>,
}

impl Drive {
    fn of(vehicle: VehicleParameters) -> Self {
        Self {
            intake: Intake::new(vehicle, Tuning::default()).unwrap(),
            now_ms: 0,
            samples: Vec::new(),
        }
    }

    fn put(&mut self, signal: Signal, value: Value) {
        let now = Instant::from_micros(self.now_ms * 1000);
        self.intake.on_reading(now, Reading { signal, value });
    }

    /// Drives on for some seconds with these readings every 100 ms, in their order; the samples of
    /// that time.
    fn on(&mut self, seconds: f64, readings: &[(Signal, f32)]) -> Vec<Sample> {
        let values: Vec<(Signal, Value)> = readings
            .iter()
            .map(|&(signal, value)| (signal, Value::Real(value)))
            .collect();
        self.on_values(seconds, &values)
    }

    fn on_values(&mut self, seconds: f64, readings: &[(Signal, Value)]) -> Vec<Sample> {
        let first = self.samples.len();
        for _ in 0..(10.0 * seconds).round() as u64 {
            for &(signal, value) in readings {
                self.put(signal, value);
            }
            while let Some(sample) = self.intake.next_sample() {
                self.samples.push(sample);
            }
            self.now_ms += 100;
        }
        self.samples[first..].to_vec()
    }
}

/// 20 m/s in the direct gear with half the torque, and these readings before them.
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
        .filter(|sample| sample.place.condition.is_valid())
        .count()
}

/// Seconds of `samples` until the model holds again.
fn seconds_invalid(samples: &[Sample]) -> f64 {
    let begin = samples[0].place.time;
    samples
        .iter()
        .rev()
        .find(|sample| !sample.place.condition.is_valid())
        .map_or(0.0, |sample| {
            sample.place.time.since(begin).micros() as f64 * 1e-6
        })
}

fn is_between(found: f64, low: f64, high: f64) {
    assert!((low..=high).contains(&found), "{found}: {low} to {high}");
}

#[test]
fn each_brake_has_its_hold_time() {
    for (signal, on, off, hold) in [
        (Signal::BrakeSwitch, 1.0, 0.0, 1.0),
        (Signal::BrakePedal, 12.0, 0.0, 1.0),
        (Signal::BrakePressure, 80_000.0, 0.0, 1.0),
        (Signal::ParkingBrake, 1.0, 0.0, 1.0),
        (Signal::RetarderTorque, -20.0, 0.0, 2.0),
    ] {
        let mut drive = Drive::of(truck());
        let before = drive.on(5.0, &cruising(&[(signal, off)]));
        assert_eq!(valid(&before), before.len(), "{signal:?}");
        let during = drive.on(3.0, &cruising(&[(signal, on)]));
        // Only the cell that was open when it came on.
        assert!(valid(&during) <= 1, "{signal:?}");
        assert!(during.last().unwrap().place.condition.braking);
        let after = drive.on(6.0, &cruising(&[(signal, off)]));
        is_between(seconds_invalid(&after), hold - 0.25, hold + 0.25);
    }
}

#[test]
fn a_retarder_at_rest_drags_a_percent_and_no_brake_is_meant() {
    let mut drive = Drive::of(truck());
    let samples = drive.on(10.0, &cruising(&[(Signal::RetarderTorque, -1.0)]));
    assert_eq!(valid(&samples), samples.len());
}

#[test]
fn either_of_two_retarders_counts() {
    let mut intake = Intake::new(truck(), Tuning::default()).unwrap();
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
        // The engine's first and always, the gearbox's from 5 s on.
        intake.on_frame(now, &frame(0x0f, 0.0));
        intake.on_frame(now, &frame(0x10, if k < 50 { 0.0 } else { -30.0 }));
        intake.on_frame(now, &frame(0x0f, 0.0));
        for (signal, value) in cruising(&[]) {
            let value = Value::Real(value);
            intake.on_reading(now, Reading { signal, value });
        }
        while let Some(sample) = intake.next_sample() {
            braking.push((k, sample.place.condition.braking));
        }
    }
    for (k, braking) in braking {
        assert_eq!(braking, k >= 50, "{k}");
    }
}

#[test]
fn a_brake_whose_sender_falls_silent_is_believed_for_seconds_not_for_ever() {
    for nothing in [None, Some(Value::NotAvailable), Some(Value::Error)] {
        let mut drive = Drive::of(truck());
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
        // 5 s until the last word is stale, then the hold time.
        is_between(seconds_invalid(&after), 5.6, 6.2);
    }
}

#[test]
fn a_gear_shift_holds_and_passes_no_torque_where_the_driveline_is_not_told() {
    let mut drive = Drive::of(truck());
    let flag = |on: f32| cruising(&[(Signal::ShiftInProcess, on)]);
    let before = drive.on(5.0, &flag(0.0));
    assert!(before.last().unwrap().load.traction_n > 4_000.0);
    let during = drive.on(1.0, &flag(1.0));
    assert!(during.last().unwrap().place.condition.shifting);
    assert_eq!(during.last().unwrap().load.traction_n, 0.0);
    let after = drive.on(5.0, &flag(0.0));
    is_between(seconds_invalid(&after), 0.75, 1.25);
    assert!(after.last().unwrap().load.traction_n > 4_000.0);
}

#[test]
fn an_open_driveline_coasts_without_traction_and_the_model_holds() {
    let mut drive = Drive::of(truck());
    let closed = drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 1.0)]));
    assert_eq!(valid(&closed), closed.len());
    // Idling: what burns is what friction takes.
    let idle = [
        (Signal::EngineSpeed, 600.0),
        (Signal::DrivelineEngaged, 0.0),
        (Signal::EngineTorque, 7.0),
    ];
    let open = drive.on(10.0, &cruising(&idle));
    is_between(seconds_invalid(&open), 0.75, 1.25);
    assert_eq!(open.last().unwrap().load.traction_n, 0.0);
    let closed = drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 1.0)]));
    is_between(seconds_invalid(&closed), 0.75, 1.25);
    assert!(closed.last().unwrap().load.traction_n > 4_000.0);
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
        let mut drive = Drive::of(truck());
        drive.on(5.0, &cruising(&[]));
        let samples = drive.on(5.0, &cruising(signals));
        for sample in &samples[1..] {
            assert!(sample.load.traction_n.abs() < 1e-3, "{signals:?}");
            // Half the torque goes somewhere: the clutch may be passing it after all.
            assert!(!sample.place.condition.is_valid(), "{signals:?}");
        }
    }
}

#[test]
fn a_slipping_clutch_is_not_trusted() {
    let mut drive = Drive::of(truck());
    let engaged = (Signal::DrivelineEngaged, 1.0);
    drive.on(5.0, &cruising(&[engaged, (Signal::ClutchSlip, 0.0)]));
    let slipping = drive.on(3.0, &cruising(&[engaged, (Signal::ClutchSlip, 30.0)]));
    assert!(valid(&slipping) <= 1);
    let closed = drive.on(5.0, &cruising(&[engaged, (Signal::ClutchSlip, 2.0)]));
    is_between(seconds_invalid(&closed), 0.75, 1.25);
}

#[test]
fn an_open_driveline_whose_sender_has_no_measurement_stays_open_until_that_is_stale() {
    let mut drive = Drive::of(truck());
    drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 0.0)]));
    let mut readings = vec![(Signal::DrivelineEngaged, Value::Error)];
    readings.extend(
        cruising(&[])
            .into_iter()
            .map(|(signal, value)| (signal, Value::Real(value))),
    );
    let after = drive.on_values(10.0, &readings);
    let begin = after[0].place.time;
    let closes = after
        .iter()
        .find(|sample| sample.load.traction_n > 1_000.0)
        .unwrap();
    let seconds = closes.place.time.since(begin).micros() as f64 * 1e-6;
    is_between(seconds, 4.5, 5.3);
}

#[test]
fn a_gear_that_the_engine_does_not_turn_with_is_not_believed() {
    // Nothing tells of the clutch: the gear stays what it was while the engine runs off.
    let mut drive = Drive::of(truck());
    let closed = drive.on(5.0, &cruising(&[]));
    assert_eq!(valid(&closed), closed.len());
    let mut away = cruising(&[]);
    for reading in &mut away {
        if reading.0 == Signal::EngineSpeed {
            reading.1 = 1.3 * RPM;
        }
    }
    let open = drive.on(5.0, &away);
    assert!(valid(&open) <= 1);
    for sample in &open[1..] {
        assert!(sample.load.traction_n.abs() < 1e-3);
    }
    // A gearbox that tells of its clutch is believed.
    let mut drive = Drive::of(truck());
    away.insert(0, (Signal::DrivelineEngaged, 1.0));
    let told = drive.on(5.0, &away);
    assert_eq!(valid(&told), told.len());
}

#[test]
fn a_gearbox_that_falls_silent_leaves_no_traction() {
    let mut drive = Drive::of(truck());
    drive.on(5.0, &cruising(&[(Signal::DrivelineEngaged, 0.0)]));
    let torque_only = [(Signal::EngineTorque, 57.0), (Signal::WheelSpeed, 20.0)];
    let samples = drive.on(12.0, &torque_only);
    let last = samples.last().unwrap();
    assert!(last.place.condition.no_traction, "{last:?}");
    assert_eq!(last.load.traction_n, 0.0);
}

#[test]
fn brakes_that_nobody_tells_of_are_guessed_from_the_deceleration() {
    // 7 % of friction in the direct gear is all that the engine brakes with.
    let overrun = |mps: f32| {
        cruising(&[
            (Signal::DrivelineEngaged, 1.0),
            (Signal::EngineTorque, 0.0),
            (Signal::WheelSpeed, mps),
        ])
    };
    let braked = |told: bool, deceleration: f32| {
        let mut drive = Drive::of(truck());
        let mut mps = 22.0;
        let mut flagged = Vec::new();
        for second in 0..40 {
            for _ in 0..10 {
                let slows = if second < 30 { 0.02 } else { deceleration };
                mps = (mps - 0.1 * slows).max(8.0);
                let mut readings = overrun(mps);
                if told {
                    readings.insert(0, (Signal::BrakeSwitch, 0.0));
                }
                let samples = drive.on(0.1, &readings);
                let hits = samples.len() - valid(&samples);
                flagged.push((second, hits));
            }
        }
        let hits = |seconds: std::ops::Range<i32>| -> usize {
            let within = flagged
                .iter()
                .filter(|(second, _)| seconds.contains(second));
            within.map(|(_, hits)| hits).sum()
        };
        let counted = drive.intake.counters().brakes_guessed;
        assert_eq!(counted, flagged.iter().map(|f| f.1 as u64).sum::<u64>());
        (hits(0..30), hits(31..38))
    };
    let (before, during) = braked(false, 1.0);
    assert_eq!(before, 0);
    assert!(during > 35, "{during} cells");
    assert_eq!(
        braked(true, 1.0),
        (0, 0),
        "a switch that says no is believed"
    );
    assert_eq!(braked(false, 0.2), (0, 0), "a slope may do that");
}

/// By a measured force, with these readings at this speed.
fn by_force() -> VehicleParameters {
    VehicleParameters {
        traction: Traction::Force,
        ..truck()
    }
}

fn at(mps: f32, mass_kg: Option<f32>) -> Vec<(Signal, f32)> {
    let mass = mass_kg.map(|kg| (Signal::Mass, kg));
    let force = (Signal::TractionForce, 4_000.0);
    let speed = (Signal::WheelSpeed, mps);
    mass.into_iter().chain([force, speed]).collect()
}

fn masses(samples: &[Sample]) -> Vec<f32> {
    let mut masses: Vec<f32> = samples.iter().map(|sample| sample.load.mass_kg).collect();
    masses.dedup();
    masses
}

fn reopenings(drive: &Drive) -> usize {
    drive
        .samples
        .iter()
        .filter(|sample| sample.reopened)
        .count()
}

#[test]
fn the_first_mass_counts_and_what_sways_while_driving_does_not() {
    let mut drive = Drive::of(by_force());
    assert_eq!(masses(&drive.on(5.0, &at(20.0, None))), [39_000.0]);
    assert_eq!(
        masses(&drive.on(5.0, &at(20.0, Some(40_000.0)))),
        [40_000.0]
    );
    let swaying = drive.on(5.0, &at(20.0, Some(40_400.0)));
    assert_eq!(masses(&swaying), [40_000.0]);
    // A stop of two seconds is a traffic light; one of ten may be a ramp.
    drive.on(2.0, &at(0.0, Some(40_400.0)));
    assert_eq!(masses(&drive.on(2.0, &at(20.0, None))), [40_000.0]);
    drive.on(10.0, &at(0.0, Some(40_400.0)));
    assert_eq!(masses(&drive.on(2.0, &at(20.0, None))), [40_400.0]);
    assert_eq!(
        reopenings(&drive),
        0,
        "one percent is what weighing is worth"
    );
}

#[test]
fn another_load_taken_at_a_stop_reopens_once_whenever_it_is_told() {
    // While it stands, just after, and when it is first told long after.
    for (standing, soon) in [
        (Some(20_000.0), Some(20_000.0)),
        (Some(39_000.0), Some(20_000.0)),
        (None, None),
    ] {
        let mut drive = Drive::of(by_force());
        drive.on(20.0, &at(20.0, Some(39_000.0)));
        drive.on(10.0, &at(0.0, standing));
        drive.on(50.0, &at(20.0, soon));
        drive.on(1.0, &at(20.0, Some(20_000.0)));
        let after = drive.on(20.0, &at(20.0, Some(20_400.0)));
        assert_eq!(masses(&after), [20_000.0]);
        assert_eq!(reopenings(&drive), 1);
    }
}

#[test]
fn masses_that_no_vehicle_like_this_has_are_left_out() {
    let mut drive = Drive::of(by_force());
    for kg in [0.0, 3_000.0, 640_000.0, f32::NAN] {
        assert_eq!(masses(&drive.on(5.0, &at(20.0, Some(kg)))), [39_000.0]);
        drive.on(10.0, &at(0.0, Some(kg)));
    }
    assert_eq!(reopenings(&drive), 0);
}

#[test]
fn a_long_standstill_reopens_whether_heard_or_slept_through() {
    let stop = |minutes: u64, awake: bool| {
        let mut drive = Drive::of(by_force());
        drive.on(20.0, &at(20.0, None));
        drive.on(5.0, &at(0.0, None));
        if awake {
            drive.on(60.0 * minutes as f64, &at(0.0, None));
        } else {
            drive.now_ms += 60_000 * minutes;
        }
        drive.on(5.0, &at(0.0, None));
        let after = drive.on(20.0, &at(20.0, None));
        assert_eq!(reopenings(&drive), usize::from(after[0].reopened));
        after[0].reopened
    };
    for awake in [true, false] {
        assert!(!stop(9, awake));
        assert!(stop(10, awake));
    }
    assert!(stop(16 * 60, false));
}

#[test]
fn a_log_that_goes_on_the_next_day_reopens() {
    let mut drive = Drive::of(by_force());
    drive.on(20.0, &at(20.0, None));
    drive.now_ms += 12 * 3_600_000;
    let after = drive.on(20.0, &at(20.0, None));
    assert!(after[0].reopened && after[0].gap_cells > 0);
    assert_eq!(reopenings(&drive), 1);
}

#[test]
fn a_cell_in_which_the_vehicle_stood_long_is_measured_where_it_is() {
    let mut drive = Drive::of(by_force());
    drive.on(20.0, &at(2.0, None));
    // 1.3 m into a cell.
    drive.on(300.0, &at(0.0, None));
    let after = drive.on(5.0, &at(2.0, None));
    let speed = after[0].speed.unwrap();
    assert!((0.0..2.5).contains(&speed.behind_m), "{speed:?}");
    assert!((0.0..=2.0).contains(&speed.mean_mps), "{speed:?}");
    assert!(after[0].duration_s > 300.0);
}

#[test]
fn what_was_learned_is_given_up_when_the_sample_says_so() {
    let learned = |reopened: bool| {
        let (vehicle, tuning) = (truck(), Tuning::default());
        let mut filter = Filter::<f64>::new();
        let mut counters = Counters::default();
        // Hills of 2 % and 2 km, driven at a steady speed.
        for cell in 0..12_000_u16 {
            let angle = f32::from(cell) * (2.5 / 2_000.0 * core::f32::consts::TAU);
            let force_n = 3_926.0 + 39_000.0 * 9.806_65 * 0.02 * angle.sin();
            let mut sample = sample(cell.into(), force_n, 20.0);
            sample.speed = speed(20.0);
            sample.reopened = reopened && cell == 11_999;
            if cell % 8 == 0 {
                sample.altitude = altitude(100.0 - 6.366 * angle.cos());
            }
            filter.step(&vehicle, &tuning, &sample, &mut counters);
        }
        let state = filter.state().unwrap();
        let found = (state.sigma(SCALE), state.sigma(BIAS), state.x[SCALE]);
        (found, counters.loads_reopened)
    };
    let (before, none) = learned(false);
    let (after, once) = learned(true);
    assert_eq!((none, once), (0, 1));
    assert!(before.0 < 0.03 && before.1 < 0.2, "{before:?}");
    assert!((after.0 - 0.1).abs() < 0.005, "{after:?}");
    assert!(after.1 > 0.3, "{after:?}");
    assert!((after.2 - before.2).abs() < 0.02, "{before:?} {after:?}");
}
