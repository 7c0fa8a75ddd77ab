//! Stops and brakes on simulated drives: the error after a launch, with a missing brake signal and
//! with a changed load.

use estimator_core::{Instant, Reading, Signal, Tuning, Value};
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{SimulatedRun, simulate};
use test_kit::simulated::{readings, scenario};

/// A reading and its time, s.
type Timed = (f64, Reading);

/// Returns the readings of a drive, `from_s` seconds later and without the signals in `without`.
fn reported(run: &SimulatedRun, without: &[Signal], from_s: f64) -> Vec<Timed> {
    let start = run.frames[0].time;
    readings(run)
        .into_iter()
        // The speed of one axle only, as with the source lock on a bus.
        .filter(|(_, _, signal, _)| !without.contains(signal) && *signal != Signal::FrontAxleSpeed)
        .map(|(time, _, signal, value)| {
            let seconds = from_s + 1e-6 * time.since(start).micros() as f64;
            (seconds, Reading { signal, value })
        })
        .collect()
}

fn estimate(run: &SimulatedRun, tuning: &Tuning, reported: &[Timed]) -> SmoothedRun {
    let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), tuning.clone()).unwrap();
    for (seconds, reading) in reported {
        let time = Instant::from_micros((1e6 * (1.0 + seconds)).round() as u64);
        recorder.on_reading(time, *reading);
    }
    recorder.finish().unwrap()
}

/// Returns the true grade, %.
fn true_grade(run: &SimulatedRun, distance_m: f64) -> f64 {
    let after = run
        .truth
        .partition_point(|row| row.distance_m < distance_m)
        .min(run.truth.len() - 1);
    run.truth[after].grade_percent
}

/// Returns the RMS of the smoothed, lagged and live grade errors from `from_m` to `to_m`, and the
/// mean normalised square of the smoothed one. The run's distances are `ahead_m` larger than those
/// of the truth.
fn errors(
    run: &SimulatedRun,
    found: &SmoothedRun,
    ahead_m: f64,
    from_m: f64,
    to_m: f64,
) -> [f64; 4] {
    let mut sums = [0.0; 4];
    let mut count = 0.0;
    for row in &found.rows {
        let at_m = row.distance_m - ahead_m;
        if !(from_m..to_m).contains(&at_m) {
            continue;
        }
        let truth = true_grade(run, at_m);
        for (sum, grade) in sums.iter_mut().zip([
            row.grade_percent,
            row.lagged_grade_percent,
            row.live_grade_percent,
        ]) {
            *sum += (grade - truth).powi(2);
        }
        sums[3] += ((row.grade_percent - truth) / row.grade_sigma_percent).powi(2);
        count += 1.0;
    }
    assert!(count > 10.0, "{count} cells");
    let rms = |sum: f64| (sum / count).sqrt();
    [rms(sums[0]), rms(sums[1]), rms(sums[2]), sums[3] / count]
}

/// Returns the means of `errors` up to `to_m` over drives on steep roads.
fn mean_errors(
    truck: &str,
    start: &str,
    tuning: &Tuning,
    without: &[Signal],
    to_m: f64,
) -> [f64; 4] {
    let mut sums = [0.0; 4];
    let mut drives = 0.0;
    for seed in 1..=4 {
        for direction in ["forward", "backward"] {
            let run = simulate(
                &scenario(&[&format!(
                    "seed = {seed}\n\
                     [road]\nlength_m = 12000.0\ngrade_sigma_percent = 2.0\n\
                     [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\nstart = \"{start}\"\n\
                     direction = \"{direction}\"\nstart_distance_m = {}\nlength_m = {}\n",
                    700 * seed,
                    to_m + 500.0
                )]),
                0,
            )
            .unwrap();
            let found = estimate(&run, tuning, &reported(&run, without, 0.0));
            for (sum, error) in sums.iter_mut().zip(errors(&run, &found, 0.0, 0.0, to_m)) {
                *sum += error;
            }
            drives += 1.0;
        }
    }
    sums.map(|sum| sum / drives)
}

const CLUTCH: &[Signal] = &[Signal::DrivelineEngaged, Signal::ClutchSlip];
const GEARBOX: &[Signal] = &[
    Signal::DrivelineEngaged,
    Signal::ClutchSlip,
    Signal::ShiftInProcess,
];
const BRAKES: &[Signal] = &[
    Signal::BrakeSwitch,
    Signal::BrakePedal,
    Signal::ParkingBrake,
];

#[test]
fn a_launch_on_a_hill_does_not_corrupt_the_slope() {
    // With a slipping clutch at launch an open driveline once counted as coasting: 6.5 % on B.
    for truck in ["A", "B"] {
        for (without, bar) in [(&[][..], 0.5), (CLUTCH, 0.5), (GEARBOX, 0.7)] {
            let [smoothed, lagged, live, _] =
                mean_errors(truck, "standstill", &Tuning::default(), without, 500.0);
            assert!(smoothed < bar, "{truck} without {without:?}: {smoothed}");
            assert!(lagged < bar, "{truck} without {without:?}: {lagged}");
            assert!(live < 1.0, "{truck} without {without:?}: {live}");
        }
    }
}

#[test]
#[ignore = "not yet: A without brake signals: live 1.3 % where reported brakes leave 0.16 %"]
fn undeclared_braking_is_not_read_as_uphill() {
    for truck in ["A", "B"] {
        let tuning = Tuning::default();
        let errors = |without| mean_errors(truck, "set_speed", &tuning, without, 6_500.0);
        let (reported, untold) = (errors(&[]), errors(BRAKES));
        for k in 0..3 {
            assert!(
                untold[k] < 1.5 * reported[k] + 0.02,
                "{truck}: {untold:?}, reported {reported:?}"
            );
        }
        assert!(untold[3] < 1.5, "{truck}: normalised square {}", untold[3]);
    }
}

/// Returns a scenario of 8 km with one load and 6 km with another.
fn two_loads(seed: u32, factors: (f64, f64)) -> Scenario {
    let run = |name: &str, start: &str, kg: f64, factor: f64, from_m: f64, length_m: f64| {
        format!(
            "[[runs]]\nname = \"{name}\"\ntruck = \"A\"\nstart = \"{start}\"\nmass_kg = {kg:?}\n\
             start_distance_m = {from_m:?}\nlength_m = {length_m:?}\n\
             errors = {{ mass_factor = {factor:?} }}\n"
        )
    };
    scenario(&[
        &format!("seed = {seed}\n[road]\nlength_m = 16000.0\n"),
        &run("full", "set_speed", 39_000.0, factors.0, 0.0, 8_000.0),
        &run(
            "light",
            "standstill",
            26_000.0,
            factors.1,
            BRAKING_M + 8_000.0,
            6_000.0,
        ),
    ])
}

/// Braking distance from 22 m/s at 1 m/s².
const BRAKING_M: f64 = 242.0;

/// Returns the readings of braking to a stop after `from_s` and of a stop of 20 s.
fn stop(from_s: f64, mass_kg: f32) -> Vec<Timed> {
    let mut reported = Vec::new();
    for tenth in 1..=420 {
        let seconds = 0.1 * f64::from(tenth);
        let mps = (22.0 - seconds).max(0.0) as f32;
        for (signal, value) in [
            (Signal::BrakeSwitch, 1.0),
            (Signal::Mass, if mps > 0.0 { 39_000.0 } else { mass_kg }),
            (Signal::WheelSpeed, mps),
        ] {
            let value = Value::Real(value);
            reported.push((from_s + seconds, Reading { signal, value }));
        }
    }
    reported
}

#[test]
fn another_load_after_a_stop_is_learned_as_on_a_fresh_start() {
    let mut means = [[0.0; 4]; 2];
    let mut scales = [0.0; 2];
    let cases = [
        (1, (1.10, 0.90)),
        (2, (1.10, 0.90)),
        (3, (0.90, 1.10)),
        (4, (0.90, 1.10)),
        (5, (1.10, 0.90)),
        (6, (0.90, 1.10)),
    ];
    for (seed, factors) in cases {
        let scenario = two_loads(seed, factors);
        let (full, light) = (
            simulate(&scenario, 0).unwrap(),
            simulate(&scenario, 1).unwrap(),
        );
        let mut joined = reported(&full, &[], 0.0);
        let end_s = joined.last().unwrap().0;
        joined.extend(stop(end_s, 26_000.0));
        let end_s = joined.last().unwrap().0 + 0.1;
        let ahead_m = |found: &SmoothedRun| {
            // The start of the second drive.
            let begins = found.rows.iter().find(|row| row.time_s > end_s).unwrap();
            begins.distance_m
        };
        joined.extend(reported(&light, &[], end_s));

        let fresh = estimate(&light, &Tuning::default(), &reported(&light, &[], 0.0));
        let reopened = estimate(&full, &Tuning::default(), &joined);
        assert_eq!(reopened.counters.loads_reopened, 1);
        for (k, (run, ahead_m)) in [(&fresh, 0.0), (&reopened, ahead_m(&reopened))]
            .into_iter()
            .enumerate()
        {
            let found = errors(&light, run, ahead_m, 2_000.0, 5_000.0);
            for (mean, error) in means[k].iter_mut().zip(found) {
                *mean += error / cases.len() as f64;
            }
            let scale = run.rows.last().unwrap().scale;
            scales[k] += (scale - 1.0 / factors.1).abs() / cases.len() as f64;
        }
    }
    let [fresh, reopened] = means;
    // The smoothed error, its normalised square, and the scale at the end.
    assert!(reopened[0] < 1.5 * fresh[0], "{reopened:?}, {fresh:?}");
    assert!(reopened[3] < 1.5, "{reopened:?}, {fresh:?}");
    assert!(scales[1] < scales[0] + 0.03, "{scales:?}");
}
