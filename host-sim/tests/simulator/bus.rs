//! The simulated bus reports what the simulated truck did.

use embedded_can::{Frame, Id};
use estimator_core::{Driveline, Estimator, Signal, Traction, Tuning, Value, VehicleParameters};
use host_sim::simulator::{Recording, SimulatedRun, simulate};
use host_sim::source::can_frame::TimedFrame;
use std::collections::BTreeMap;
use test_kit::simulated::{A, B, MILD, QUIET, readings, run, scenario, series, without_sessions};

/// Returns (time, altitude) as the vehicle model integrates it from the bus alone.
fn altitude_of_the_bus(run: &SimulatedRun, vehicle: &VehicleParameters) -> Vec<(f64, f64)> {
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        panic!("the presets have engines");
    };
    let mut latest = BTreeMap::new();
    let mut force = (0.0, 0);
    let mut last_speed = None;
    let mut altitude_m = 0.0;
    let mut profile = Vec::new();
    let start = run.frames[0].time;
    for (time, _, signal, value) in readings(run) {
        let Some(value) = value.real() else { continue };
        latest.insert(signal, value);
        let all = [
            Signal::EngineTorqueFraction,
            Signal::FrictionTorque,
            Signal::GearRatio,
            Signal::AirPressure,
            Signal::AmbientTemperature,
        ]
        .map(|signal| latest.get(&signal).copied());
        let [
            Some(fraction),
            Some(friction),
            Some(ratio),
            Some(pressure),
            Some(celsius),
        ] = all
        else {
            continue;
        };
        let driveline = Driveline::Engaged(powertrain.gear_of_ratio(ratio, 0.05).unwrap());
        if signal == Signal::EngineTorque {
            force.0 += f64::from(vehicle.traction_n(
                driveline,
                value + fraction - friction,
                vehicle.wheel_radius_m,
            ));
            force.1 += 1;
        }
        if signal != Signal::WheelSpeed || force.1 == 0 {
            continue;
        }
        let seconds = 1e-6 * time.since(start).micros() as f64;
        let speed = f64::from(value);
        if let Some((at, before)) = last_speed.replace((seconds, speed)) {
            let driven_m = 0.5 * (speed + before) * (seconds - at);
            let density = f64::from(pressure) / (287.05 * (f64::from(celsius) + 273.15));
            let weight_n = f64::from(vehicle.mass_kg) * 9.806_65;
            let resistance_n = 0.25
                * f64::from(vehicle.drag_area_m2)
                * density
                * (speed * speed + before * before)
                + weight_n * f64::from(vehicle.rolling_resistance);
            let accelerated_kg =
                vehicle.mass_kg + vehicle.rotating_kg(driveline, vehicle.wheel_radius_m);
            let kinetic_j = 0.5 * f64::from(accelerated_kg) * (speed * speed - before * before);
            let mean_n = force.0 / f64::from(force.1);
            altitude_m += ((mean_n - resistance_n) * driven_m - kinetic_j) / weight_n;
        }
        force = (0.0, 0);
        profile.push((seconds, altitude_m));
    }
    profile
}

#[test]
fn the_bus_carries_the_force_balance() {
    for truck in [A, B] {
        let run = run(&[QUIET, MILD, truck]);
        let profile = altitude_of_the_bus(&run, &run.vehicle.model.vehicle);
        assert_eq!(
            run.truth
                .iter()
                .map(|row| row.shifting + row.braking)
                .sum::<u8>(),
            0
        );
        let climbed = |time_s: f64| {
            let row = run.truth.iter().find(|row| row.time_s >= time_s);
            row.map(|row| row.altitude_m)
        };
        let from_m = climbed(profile[0].0).unwrap();
        let heights = run.truth.iter().map(|row| row.altitude_m);
        let range_m = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
        assert!(range_m > 8.0, "a flat road would show nothing: {range_m}");
        // Friction (SPN 514) is rounded to 1 %: half of it is 9 to 12 Nm, which over 5 km is
        // 0.7 m for A and 2.8 m for B.
        let allowed_m = if run.name == "a" { 0.7 } else { 2.8 };
        for (time_s, altitude_m) in profile {
            if let Some(truth_m) = climbed(time_s) {
                let error_m = altitude_m - (truth_m - from_m);
                assert!(
                    error_m.abs() < allowed_m,
                    "{}: {error_m} m at {time_s} s",
                    run.name
                );
            }
        }
    }
}

#[test]
fn a_wrong_torque_is_a_wrong_scale_of_the_signal() {
    let text = format!("{QUIET}{MILD}{A}errors.torque_factor = 0.9\n");
    let scenario = scenario(&[&text]);
    let run = simulate(&scenario, 0).unwrap();
    let recording = Recording::new(&scenario, 0).unwrap();
    let Traction::Powertrain(assumed) = &run.vehicle.model.vehicle.traction else {
        panic!("A has an engine");
    };
    assert_eq!(assumed.reference_torque_nm, 1750.0);
    let mut latest = BTreeMap::new();
    let mut compared = 0;
    for (time, _, signal, value) in readings(&run) {
        let Some(value) = value.real() else { continue };
        latest.insert(signal, value);
        let (Some(friction), Signal::EngineTorque) = (latest.get(&Signal::FrictionTorque), signal)
        else {
            continue;
        };
        let percent = value + latest[&Signal::EngineTorqueFraction] - friction;
        let reported_nm = 0.01 * f64::from(percent) * 1750.0;
        let state = recording.drive().at(1e-6 * time.micros() as f64);
        // Friction is rounded to 1 %, and times differ by one message.
        let error_nm = 0.9 * reported_nm - state.net_torque_nm;
        assert!(error_nm.abs() < 0.9 * 17.5 * 0.6 + 2.0, "{error_nm}");
        compared += 1;
    }
    assert!(compared > 10_000);
}

#[test]
fn messages_come_at_their_rates() {
    let run = run(&["rates.fast_ms = 20.0\n", MILD, A]);
    let seconds = 1e-6
        * run
            .frames
            .last()
            .unwrap()
            .time
            .since(run.frames[0].time)
            .micros() as f64;
    let mut counts: BTreeMap<u32, f64> = BTreeMap::new();
    let mut senders: BTreeMap<u32, u8> = BTreeMap::new();
    for timed in without_sessions(run.frames.clone()) {
        let Id::Extended(id) = timed.frame.id() else {
            panic!("all identifiers here have 29 bits");
        };
        let pgn = (id.as_raw() >> 8) & 0x3_ffff;
        *counts.entry(pgn).or_default() += 1.0;
        assert_eq!(
            *senders.entry(pgn).or_insert(id.as_raw() as u8),
            id.as_raw() as u8
        );
    }
    let expected = [
        (61_444, 100.0),
        (65_247, 4.0),
        (65_265, 10.0),
        (65_215, 10.0),
        (61_442, 50.0),
        (61_445, 10.0),
        (61_440, 10.0),
        (61_441, 10.0),
        (65_269, 1.0),
        (61_449, 50.0),
        (65_213, 1.0),
        (65_136, 0.1),
        (129_025, 10.0),
        (129_026, 4.0),
        (129_029, 7.0),
        (129_539, 1.0),
    ];
    assert_eq!(counts.len(), expected.len(), "{counts:?}");
    for (pgn, rate) in expected {
        let frames = counts[&pgn];
        let whole = if pgn == 129_029 { 7.0 } else { 1.0 };
        assert!(
            (frames - rate * seconds).abs() <= whole + 1e-3 * rate * seconds,
            "{pgn}: {frames} in {seconds} s"
        );
    }
    assert!(run.frames.is_sorted_by(|a, b| a.time < b.time));
    assert!(
        senders
            .values()
            .collect::<std::collections::BTreeSet<_>>()
            .len()
            >= 5
    );
}

#[test]
fn the_receiver_reports_the_true_position() {
    let text = format!("{QUIET}[road]\nlength_m = 4000.0\n{B}direction = \"backward\"\n");
    let scenario = scenario(&[&text]);
    let run = simulate(&scenario, 0).unwrap();
    let recording = Recording::new(&scenario, 0).unwrap();
    let (road, drive) = (&recording.drive().road, recording.drive());
    let mut compared = [0; 4];
    for (time, _, signal, value) in readings(&run) {
        // The last frame of a packet is 4 ms after its first: 0.1 m.
        let state = drive.at(1e-6 * time.micros() as f64);
        let position = road.position(state.distance_m);
        match (signal, value) {
            (Signal::Altitude, Value::Real(altitude_m)) => {
                assert!((f64::from(altitude_m) - road.altitude_m(state.distance_m)).abs() < 0.01);
                compared[0] += 1;
            }
            (Signal::Latitude, Value::DegreesE7(angle)) => {
                assert!((f64::from(angle) * 1e-7 - position.latitude_deg).abs() < 2e-6);
                compared[1] += 1;
            }
            (Signal::Longitude, Value::DegreesE7(angle)) => {
                assert!((f64::from(angle) * 1e-7 - position.longitude_deg).abs() < 4e-6);
                compared[2] += 1;
            }
            (Signal::Course, Value::Real(course_deg)) => {
                // The default road heads south-west; this run comes back.
                assert!((0.0..90.0).contains(&course_deg), "{course_deg}");
                compared[3] += 1;
            }
            _ => {}
        }
    }
    assert!(compared.iter().all(|&n| n > 100), "{compared:?}");
}

#[test]
fn engine_and_retarder_say_every_5_s_what_they_are() {
    let run = run(&["[road]\nlength_m = 3000.0\n", A]);
    let torques = series(&run, Signal::EngineReferenceTorque);
    assert!(torques.len() > 20, "{}", torques.len());
    assert!(torques.iter().all(|(_, torque_nm)| *torque_nm == 1_750.0));
    let period_s = (torques[20].0 - torques[0].0) / 20.0;
    assert!((period_s - 5.0).abs() < 0.01, "{period_s}");
    assert_eq!(series(&run, Signal::EngineInertia).len(), torques.len());
    let retarders = series(&run, Signal::RetarderReferenceTorque);
    assert!(retarders.iter().all(|(_, torque_nm)| *torque_nm == 3_500.0));
    // Their frames are among each other.
    let sources: Vec<u32> = run
        .frames
        .iter()
        .filter_map(|timed| match timed.frame.id() {
            Id::Extended(id) if id.as_raw() >> 8 == 0x1c_ebff => Some(id.as_raw() & 0xff),
            _ => None,
        })
        .take(6)
        .collect();
    assert_eq!(sources, [0x00, 0x10, 0x00, 0x10, 0x00, 0x10]);
}

#[test]
fn multi_packet_messages_delay_no_frame_and_change_no_cell() {
    let simulated = run(&["[road]\nlength_m = 3000.0\n", B]);
    let cells = |frames: &[TimedFrame]| {
        let vehicle = simulated.vehicle.model.clone();
        let mut estimator = Estimator::<f32>::new(vehicle, Tuning::default()).unwrap();
        let mut cells = Vec::new();
        for timed in frames {
            estimator.on_frame(timed.time, &timed.frame);
            while estimator.step().is_some() {}
            while let Some(cell) = estimator.next_cell() {
                cells.push(cell);
            }
        }
        let counters = *estimator.counters();
        assert_eq!(counters.parameters_replaced + counters.sessions_broken, 0);
        cells
    };
    let alone = without_sessions(simulated.frames.clone());
    assert!(alone.len() + 100 < simulated.frames.len());
    assert_eq!(cells(&simulated.frames), cells(&alone));
    // 8 bytes at 250 kbit/s: no two frames are on the bus at once.
    for pair in simulated.frames.windows(2) {
        let apart = pair[1].time.since(pair[0].time).micros();
        assert!(apart >= 299, "{apart} µs");
    }
}

#[test]
fn tunnels_silence_the_receiver_in_both_directions() {
    for direction in ["forward", "backward"] {
        let text = format!(
            "[road]\nlength_m = 3000.0\n[gnss]\noutages_m = [[500.0, 1500.0]]\n{A}direction = \"{direction}\"\n"
        );
        let run = run(&[&text]);
        let inside = if direction == "forward" {
            300.0..1700.0
        } else {
            1300.0..2700.0
        };
        let deep = if direction == "forward" {
            520.0..1480.0
        } else {
            1520.0..2480.0
        };
        let mut silent = 0;
        for (time, _, signal, value) in readings(&run) {
            if signal != Signal::Altitude {
                continue;
            }
            let row = (1e-5 * time.since(run.frames[0].time).micros() as f64) as usize;
            let distance_m = run.truth[row.min(run.truth.len() - 1)].distance_m;
            if deep.contains(&distance_m) {
                assert_eq!(value, Value::NotAvailable);
                silent += 1;
            } else if !inside.contains(&distance_m) {
                assert!(value.is_available());
            }
        }
        assert!(silent > 30);
    }
}

#[test]
fn noise_has_the_requested_size() {
    let text = QUIET.replace("speed_sigma_mps = 0.0\nyaw", "speed_sigma_mps = 0.02\nyaw");
    let loud = run(&[&text, MILD, B]);
    let quiet = run(&[QUIET, MILD, B]);
    let pairs: Vec<f64> = series(&loud, Signal::WheelSpeed)
        .iter()
        .zip(series(&quiet, Signal::WheelSpeed))
        .map(|(a, b)| f64::from(a.1 - b.1))
        .collect();
    let sigma = (pairs.iter().map(|e| e * e).sum::<f64>() / pairs.len() as f64).sqrt();
    assert!(
        pairs.len() > 2000 && (sigma - 0.02).abs() < 0.001,
        "{sigma}"
    );

    // Altitude errors keep their value: neighbours differ far less than the whole.
    let text =
        "[gnss]\naltitude_sigma_m = 4.0\naltitude_time_s = 50.0\naltitude_white_sigma_m = 0.0\n";
    let drifting = run(&[
        text,
        "[road]\nlength_m = 40000.0\ngrade_sigma_percent = 0.0\n",
        B,
    ]);
    let errors: Vec<f64> = series(&drifting, Signal::Altitude)
        .iter()
        .map(|&(_, altitude_m)| f64::from(altitude_m) - 40.0)
        .collect();
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|e| e * e).sum::<f64>();
    let count = errors.len() as f64;
    let sigma = (square(&mut errors.iter().copied()) / count).sqrt();
    let step = (square(&mut errors.windows(2).map(|w| w[1] - w[0])) / count).sqrt();
    assert!((2.5..5.5).contains(&sigma), "{sigma}");
    // σ √(2 (1 − exp(−1/50))) = 0.8
    assert!((0.7..0.9).contains(&step), "{step}");
}

#[test]
fn the_core_finds_the_grade_of_a_simulated_road() {
    let run = run(&["[road]\nlength_m = 10000.0\n", A]);
    let vehicle = run.vehicle.model.clone();
    let mut estimator = Estimator::<f64>::new(vehicle, Tuning::default()).unwrap();
    let start = run.frames[0].time;
    let (mut squares, mut road_squares, mut count) = (0.0, 0.0, 0.0);
    for timed in &run.frames {
        estimator.on_frame(timed.time, &timed.frame);
        while estimator.step().is_some() {}
        while let Some(cell) = estimator.next_cell() {
            let steps = 1e-5 * cell.end.time.since(start).micros() as f64;
            let (row, part) = (steps as usize, steps.fract());
            let [from, to] = [run.truth[row], run.truth[row + 1]];
            let grade = from.grade_percent + part * (to.grade_percent - from.grade_percent);
            if from.distance_m > 500.0 {
                squares += (f64::from(cell.lagged_grade_percent.value) - grade).powi(2);
                road_squares += grade * grade;
                count += 1.0;
            }
        }
    }
    let rmse = (squares / count).sqrt();
    assert!(count > 3000.0 && (road_squares / count).sqrt() > 0.8);
    assert!(rmse < 0.2, "{rmse} %");
    let counters = estimator.counters();
    assert_eq!(counters.frames_ignored, 0);
    assert_eq!(
        counters.frames_malformed + counters.fast_packets_broken + counters.sessions_broken,
        0
    );
}
