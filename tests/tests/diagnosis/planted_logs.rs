//! Each log of the bench contains the requested effect, and nothing that reveals it.

use cross_tests::planted::{
    CATALOGUE, CLEAN, FAN, OUTSIDE, PlantedLogs, amount, can_be_less, logs, logs_of,
    unmodelled_rms_percent,
};
use estimator_core::signal::FrameOutcome;
use estimator_core::{Decoder, Driveline, Signal, Traction, VehicleParameters};
use host_sim::files::truth::{self, TruthRow};
use host_sim::files::vehicle::VehicleFile;
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::truck::Preset;
use host_sim::source::frame_log::FrameLog;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const TRUCKS: [&str; 2] = ["A", "B"];
/// Length over which the log's energies are compared, m. It is short beside a rough stretch, and
/// long enough for the noise of the wheel speeds at its ends (0.016 m/s at 22 m/s are 0.012 %).
const WINDOW_M: f64 = 300.0;

fn effects() -> impl Iterator<Item = &'static str> {
    CATALOGUE.into_iter().chain(OUTSIDE).chain([FAN])
}

#[test]
fn every_size_of_every_effect_can_be_made() {
    for truck in TRUCKS {
        for effect in effects() {
            let amounts = [0.05, 0.1, 0.3].map(|size_percent| {
                let amount = amount(effect, size_percent, truck, 4).unwrap();
                assert_eq!(amount.effect, effect);
                amount.amount
            });
            assert!(
                0.0 < amounts[0] && amounts[0] < amounts[1] && amounts[1] < amounts[2],
                "{effect}, {truck}: {amounts:?}"
            );
        }
        for effect in effects().filter(|effect| can_be_less(effect)) {
            let less = amount(effect, -0.1, truck, 4).unwrap();
            assert!(less.amount < 0.0, "{less:?}");
        }
    }
}

#[test]
fn logs_contain_the_requested_effect() {
    // The radius shows in the speeds and has a test of its own. The other effects here show only
    // in part. Some vary within a window and are averaged. Others are a part of the traction: they
    // are large on steep slopes, which are rare in windows without a shift.
    let partly = [
        "cornering",
        "driveline_loss",
        "mass",
        "torque_scale",
        "torque_hysteresis",
        "thermostat",
        FAN,
    ];
    for effect in effects().filter(|effect| *effect != "wheel_radius") {
        let folder = tempfile::tempdir().unwrap();
        let logs = logs(effect, 0.3, "A", 5, &folder.path().join("case")).unwrap();
        let scenario = Scenario::read(&logs.truth.scenario).unwrap();
        let rms = unmodelled_rms_percent(&scenario).unwrap();
        assert!((rms - 0.3).abs() < 0.006, "{effect}: {rms}");
        let reported = reported_rms_percent(&logs);
        let expected = if partly.contains(&effect) {
            0.24..0.29
        } else {
            0.285..0.315
        };
        assert!(expected.contains(&reported), "{effect}: {reported}");
    }
}

#[test]
fn clean_logs_contain_no_effect() {
    for truck in TRUCKS {
        let folder = tempfile::tempdir().unwrap();
        let logs = logs(CLEAN, 0.1, truck, 5, &folder.path().join("case")).unwrap();
        assert!(logs.truth.amounts.is_empty());
        let scenario = Scenario::read(&logs.truth.scenario).unwrap();
        assert!(unmodelled_rms_percent(&scenario).unwrap() < 1e-9);
        // Gusts of 0.3 m/s, the rounding of friction (SPN 514) and noise remain.
        let reported = reported_rms_percent(&logs);
        assert!(
            reported < if truck == "A" { 0.035 } else { 0.09 },
            "{reported}"
        );
    }
}

#[test]
fn a_wrong_radius_shows_between_the_speeds() {
    let folder = tempfile::tempdir().unwrap();
    let logs = logs("wheel_radius", 3.0, "B", 1, &folder.path().join("case")).unwrap();
    let (_, signals) = read(&logs.fit[1]);
    let mean = |signal: Signal| {
        let values = &signals[&signal];
        values.iter().map(|value| value.1).sum::<f64>() / values.len() as f64
    };
    let ratio = mean(Signal::GnssSpeed) / mean(Signal::WheelSpeed);
    assert!((ratio - 1.03).abs() < 5e-4, "{ratio}");
}

#[test]
fn effects_can_be_combined() {
    let folder = tempfile::tempdir().unwrap();
    let both = [("brake_drag", 0.1), ("rolling_resistance", 0.2)];
    let logs = logs_of(&both, "B", 2, &folder.path().join("case")).unwrap();
    let names: Vec<&str> = logs
        .truth
        .amounts
        .iter()
        .map(|a| a.effect.as_str())
        .collect();
    assert_eq!(names, ["brake_drag", "rolling_resistance"]);
    // Both are constant: they add.
    let scenario = Scenario::read(&logs.truth.scenario).unwrap();
    let rms = unmodelled_rms_percent(&scenario).unwrap();
    assert!((rms - 0.3).abs() < 0.006, "{rms}");
}

#[test]
fn the_logs_do_not_reveal_the_effect() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    let logs = logs("mass", 0.3, "A", 3, &case).unwrap();
    let names = |folder: &Path| {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let expected = ["fit1", "fit2", "fit3", "fit4", "held1", "held2"];
    let endings = |ending: &str| expected.map(|name| format!("{name}.{ending}"));
    assert_eq!(
        names(&case),
        [&endings("log")[..], &["vehicle.toml".to_owned()]].concat()
    );
    let vehicle = VehicleFile::read(&logs.vehicle).unwrap();
    assert_eq!(vehicle.model, Preset::A.parameters().into());
    // The reported mass (SPN 1760, in steps of 10 kg) is the assumed one, too.
    let (_, signals) = read(&logs.fit[0]);
    assert!(signals[&Signal::Mass].iter().all(|m| m.1 == 39_000.0));

    assert!(!logs.truth.folder.starts_with(&case));
    let truths = [&logs.truth.fit[..], &logs.truth.held_out].concat();
    assert_eq!(
        (logs.fit.len(), logs.held_out.len(), truths.len()),
        (4, 2, 6)
    );
    for path in truths
        .iter()
        .chain([&logs.truth.road, &logs.truth.scenario])
    {
        assert!(path.starts_with(&logs.truth.folder) && path.is_file());
    }
    // There are runs in both directions, in the logs to fit and in those held out.
    let road = &Scenario::read(&logs.truth.scenario).unwrap().road;
    let up = road.altitude_m(road.length_m()) - road.altitude_m(0.0);
    for (index, path) in truths.iter().enumerate() {
        let rows = truth::read(path).unwrap();
        let climbed = rows.last().unwrap().altitude_m - rows[0].altitude_m;
        let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
        assert!((climbed - sign * up).abs() < 1.0, "{climbed}, {up}");
    }
}

#[test]
fn the_same_seed_gives_the_same_logs_and_another_seed_another_road() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str, seed: u64| {
        let logs = logs("fan", 0.1, "B", seed, &folder.path().join(name)).unwrap();
        let road = fs::read(&logs.truth.road).unwrap();
        (road, fs::read(&logs.held_out[1]).unwrap())
    };
    let (first, again, other) = (bytes("first", 8), bytes("again", 8), bytes("other", 9));
    assert!(first == again);
    assert!(first.0 != other.0 && first.1 != other.1);
}

#[test]
fn impossible_requests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    for (effect, size_percent, truck, problem) in [
        ("magic", 0.1, "A", "magic"),
        ("mass", 0.1, "C", "C"),
        ("mass", 50.0, "A", "mass_factor"),
        ("brake_drag", -0.1, "A", "planted.brake_drag_n"),
        ("headwind", f64::NAN, "A", "headwind"),
        ("road_surface", f64::INFINITY, "B", "road_surface"),
        ("magic", 0.0, "A", "magic"),
    ] {
        let message = logs(effect, size_percent, truck, 1, &case)
            .expect_err(effect)
            .to_string();
        assert!(message.contains(problem), "{message}");
        assert!(!case.exists());
    }
}

#[test]
fn a_size_of_zero_plants_nothing_on_the_road_of_the_effect() {
    let folder = tempfile::tempdir().unwrap();
    let road = |name: &str, effect: &str, size_percent: f64| {
        let logs = logs(effect, size_percent, "A", 1, &folder.path().join(name)).unwrap();
        let planted = logs.truth.amounts.len();
        (planted, fs::read(&logs.truth.road).unwrap())
    };
    let (planted, curvy) = road("curvy", "cornering", 0.0);
    assert_eq!(planted, 0);
    assert_eq!(road("bent", "cornering", 0.1), (1, curvy.clone()));
    assert_ne!(road("straight", "mass", 0.0).1, curvy);
}

/// Values of every signal of a log with their times, s from its first frame.
type Signals = BTreeMap<Signal, Vec<(f64, f64)>>;

fn read(log: &Path) -> (VehicleParameters, Signals) {
    let vehicle = VehicleFile::read(&log.with_file_name("vehicle.toml")).unwrap();
    let mut reader = FrameLog::open_candump(log).unwrap();
    let mut decoder = Decoder::new();
    let mut signals = Signals::new();
    let mut start = None;
    while let Some(timed) = reader.next_frame().unwrap() {
        let start = *start.get_or_insert(timed.time);
        let time_s = 1e-6 * timed.time.since(start).micros() as f64;
        let outcome = decoder.decode(&timed.frame, |_, _, reading| {
            if let Some(value) = reading.value.real() {
                let values = signals.entry(reading.signal).or_default();
                values.push((time_s, f64::from(value)));
            }
        });
        assert!(
            matches!(
                outcome,
                FrameOutcome::Decoded { .. } | FrameOutcome::Partial
            ),
            "{outcome:?}"
        );
    }
    (vehicle.model.vehicle, signals)
}

/// Returns the latest value at a time.
fn at(values: &[(f64, f64)], time_s: f64) -> f64 {
    let after = values.partition_point(|value| value.0 <= time_s);
    values[after.saturating_sub(1)].1
}

/// Returns the RMS over windows without shift or brake of a grade error in %: the height that the
/// assumed force balance gives from the logged torque and speed, less the true height, over the
/// distance.
fn reported_rms_percent(logs: &PlantedLogs) -> f64 {
    let runs = logs.fit.iter().chain(&logs.held_out);
    let truths = logs.truth.fit.iter().chain(&logs.truth.held_out);
    let errors: Vec<f64> = runs
        .zip(truths)
        .flat_map(|(log, truth)| window_errors_percent(log, &truth::read(truth).unwrap()))
        .collect();
    assert!(errors.len() > 100, "{} windows", errors.len());
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

fn window_errors_percent(log: &Path, truth: &[TruthRow]) -> Vec<f64> {
    let (vehicle, signals) = read(log);
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        panic!("the presets have engines");
    };
    let series = |signal: Signal| signals[&signal].as_slice();
    let speeds = series(Signal::WheelSpeed);
    let driveline = |time_s: f64| {
        let ratio = at(series(Signal::GearRatio), time_s) as f32;
        Driveline::Engaged(powertrain.gear_of_ratio(ratio, 0.05).unwrap())
    };
    // The mean of the four readings around a time.
    let speed = |time_s: f64| {
        let after = speeds.partition_point(|value| value.0 <= time_s);
        speeds[after - 2..after + 2]
            .iter()
            .map(|v| v.1)
            .sum::<f64>()
            / 4.0
    };
    let density = at(series(Signal::AirPressure), 10.0)
        / (287.05 * (at(series(Signal::AmbientTemperature), 10.0) + 273.15));
    let weight_n = f64::from(vehicle.mass_kg) * 9.806_65;
    let mut errors = Vec::new();
    let mut from = 100;
    while let Some(rows) = truth[from..]
        .iter()
        .position(|row| row.distance_m > truth[from].distance_m + WINDOW_M)
    {
        let to = from + rows;
        let (start, end) = (&truth[from], &truth[to]);
        let quiet = truth[from - 20..=to]
            .iter()
            .all(|row| row.shifting + row.braking == 0);
        from = to;
        if !quiet || to + 20 > truth.len() {
            continue;
        }
        let radius_m = vehicle.wheel_radius_m;
        let (mut work_j, mut driven_m) = (0.0, 0.0);
        let torques = series(Signal::EngineTorque);
        let first = torques.partition_point(|value| value.0 < start.time_s);
        for pair in torques[first..].windows(2) {
            let (time_s, torque) = pair[0];
            if time_s >= end.time_s {
                break;
            }
            let percent = torque + at(series(Signal::EngineTorqueFraction), time_s)
                - at(series(Signal::FrictionTorque), time_s);
            let speed_mps = at(speeds, time_s);
            let air_n = 0.5 * f64::from(vehicle.drag_area_m2) * density * speed_mps * speed_mps;
            let force_n =
                f64::from(vehicle.traction_n(driveline(time_s), percent as f32, radius_m))
                    - air_n
                    - weight_n * f64::from(vehicle.rolling_resistance);
            let step_m = speed_mps * (pair[1].0 - time_s);
            work_j += force_n * step_m;
            driven_m += step_m;
        }
        let rotating_kg = vehicle.rotating_kg(driveline(end.time_s), radius_m);
        let accelerated_kg = f64::from(vehicle.mass_kg + rotating_kg);
        let (slow, fast) = (speed(start.time_s), speed(end.time_s));
        let kinetic_j = 0.5 * accelerated_kg * (fast * fast - slow * slow);
        let climbed_m = (work_j - kinetic_j) / weight_n;
        errors.push(100.0 * (climbed_m - (end.altitude_m - start.altitude_m)) / driven_m);
    }
    errors
}
