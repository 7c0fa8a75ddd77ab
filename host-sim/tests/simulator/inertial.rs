//! The inertial sensors of the simulator, against the true motion.

use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use estimator_core::{Estimator, Signal, Step, Tuning};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{Recording, SimulatedRun, simulate};
use std::path::Path;
use test_kit::simulated::{A, B, MILD, QUIET, run, scenario, series};

const GRAVITY: f64 = 9.806_65;
const FORWARD: Signal = Signal::LongitudinalAcceleration;
/// An accelerometer and a slope sensor without errors.
const PERFECT: &str = "\
[accelerometer]\noffset_mps2 = 0.0\ndrift_mps2 = 0.0\nscale_factor = 1.0\nmounting_deg = 0.0\n\
body_pitch_deg_per_mps2 = 0.0\nroughness_mps2 = 0.0\n\
[pitch]\noffset_deg = 0.0\ndrift_deg = 0.0\nbody_pitch_deg_per_mps2 = 0.0\nnoise_sigma_deg = 0.0\n";

/// Returns the acceleration that a perfect sensor feels, and the slope, °, for each time of a drive
/// in seconds from the first frame.
fn truth(scenario: &Scenario, times_s: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let recording = Recording::new(scenario, 0).unwrap();
    let first_s = 1e-6 * recording.frames().next().unwrap().time.micros() as f64;
    let drive = recording.drive();
    times_s
        .map(|time_s| {
            let state = drive.at(first_s + time_s);
            let slope_rad = drive.road.grade(state.distance_m).atan();
            let felt_mps2 = state.acceleration_mps2 + GRAVITY * slope_rad.sin();
            (felt_mps2, slope_rad.to_degrees())
        })
        .collect()
}

/// Returns the differences of a signal's readings from what a perfect sensor reads.
fn errors(scenario: &Scenario, signal: Signal) -> Vec<f64> {
    let readings = series(&simulate(scenario, 0).unwrap(), signal);
    let truth = truth(scenario, readings.iter().map(|(time_s, _)| *time_s));
    let exact = truth
        .into_iter()
        .map(|(felt_mps2, slope_deg)| match signal {
            Signal::Pitch => slope_deg,
            _ => felt_mps2,
        });
    let pairs = readings.iter().zip(exact);
    pairs
        .map(|((_, read), exact)| f64::from(*read) - exact)
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn frames_of(run: &SimulatedRun, pgn: u32) -> usize {
    let is_of = |id| matches!(id, Id::Extended(id) if Pgn::from_raw(id.as_raw()).number == pgn);
    run.frames.iter().filter(|of| is_of(of.frame.id())).count()
}

#[test]
fn without_their_tables_there_are_no_such_sensors() {
    let run = run(&[QUIET, MILD, A]);
    for signal in [FORWARD, Signal::Pitch, Signal::PitchRate] {
        assert!(series(&run, signal).is_empty(), "{signal:?}");
    }
    for pgn in [61_485, 61_459, 61_481] {
        assert_eq!(frames_of(&run, pgn), 0, "{pgn}");
    }
}

#[test]
fn perfect_sensors_read_the_motion_and_the_slope() {
    // Hills that make both trucks shift and brake.
    let hills = "[road]\nlength_m = 8000.0\ngrade_sigma_percent = 3.0\n";
    for truck in [A, B] {
        let scenario = scenario(&[QUIET, PERFECT, hills, truck]);
        for (signal, step, period_s) in [(FORWARD, 0.01, 0.02), (Signal::Pitch, 0.002, 0.02)] {
            let errors = errors(&scenario, signal);
            let expected = Recording::new(&scenario, 0).unwrap().drive().duration_s() / period_s;
            assert!((errors.len() as f64 / expected - 1.0).abs() < 0.02);
            // Half a step; a frame waits for the bus while the acceleration changes.
            let small = errors.iter().filter(|error| error.abs() <= 0.51 * step);
            assert!(
                small.count() as f64 > 0.9 * errors.len() as f64,
                "{signal:?}"
            );
            assert!(mean(&errors).abs() < 0.2 * step, "{}", mean(&errors));
        }
    }
}

#[test]
fn the_errors_of_the_accelerometer_are_those_of_its_table() {
    let scenario = scenario(&["[accelerometer]\n", MILD, A]);
    let errors = errors(&scenario, FORWARD);
    let times = (0..errors.len()).map(|k| 0.02 * k as f64);
    let felt: Vec<f64> = truth(&scenario, times).iter().map(|of| of.0).collect();
    // Offset and mounting; scale, and the tilt of the body, both by what is felt.
    let tilt = GRAVITY * 0.3_f64.to_radians();
    let offset_mps2 = 0.1 + 1.01 * GRAVITY * 0.2_f64.to_radians().sin();
    let expected_mps2 = offset_mps2 + (1.01 * (1.0 + tilt) - 1.0) * mean(&felt);
    let seconds = 0.02 * errors.len() as f64;
    // Vibration is 0.3 at 20 m/s, and keeps its value for 0.016 s; the walk is 0.02 after an hour.
    let noise_mps2 = 0.32 * (2.0 * 0.02 / seconds).sqrt() + 0.02 * (seconds / 3_600.0).sqrt();
    let off_mps2 = mean(&errors) - expected_mps2;
    assert!(off_mps2.abs() < 3.0 * noise_mps2, "{off_mps2} {noise_mps2}");
    let spread = errors.iter().map(|error| (error - mean(&errors)).powi(2));
    let sigma_mps2 = (spread.sum::<f64>() / errors.len() as f64).sqrt();
    assert!((0.27..0.36).contains(&sigma_mps2), "{sigma_mps2}");
}

#[test]
fn the_offset_walks_by_its_drift() {
    let still = PERFECT
        .replace("[accelerometer]\n", "")
        .replace("drift_mps2 = 0.0\n", "");
    let still = still.split("[pitch]").next().unwrap();
    let mut ends = Vec::new();
    for seed in 1..=40 {
        let head = format!("seed = {seed}\n[accelerometer]\ndrift_mps2 = 1.0\n{still}");
        let scenario = scenario(&[&head, "[road]\nlength_m = 3000.0\n", A]);
        let errors = errors(&scenario, FORWARD);
        let seconds = 0.02 * errors.len() as f64;
        let last = mean(&errors[errors.len() - 50..]);
        ends.push(last / (seconds / 3_600.0).sqrt());
    }
    let squares: Vec<f64> = ends.iter().map(|end| end * end).collect();
    // Chi-square of 40: 1 ± 3 sigma.
    assert!((mean(&squares) - 1.0).abs() < 0.67, "{}", mean(&squares));
}

#[test]
fn a_slope_sensor_reads_the_pitch_of_the_body_too() {
    let table = "[pitch]\nmessage = \"SSI2\"\ndrift_deg = 0.0\n";
    let scenario = scenario(&[table, MILD, A]);
    let errors = errors(&scenario, Signal::Pitch);
    let times = (0..errors.len()).map(|k| 0.02 * k as f64);
    let felt: Vec<f64> = truth(&scenario, times).iter().map(|of| of.0).collect();
    let off_deg = mean(&errors) - (0.2 + 0.3 * mean(&felt));
    assert!(off_deg.abs() < 0.01, "{off_deg}");
    assert_eq!(frames_of(&simulate(&scenario, 0).unwrap(), 61_459), 0);
}

#[test]
fn stability_control_can_carry_the_acceleration_in_coarse_steps() {
    let run = run(&["[accelerometer]\nmessage = \"VDC2\"\n", MILD, A]);
    assert_eq!(frames_of(&run, 61_485), 0);
    let readings = series(&run, FORWARD);
    assert!(readings.len() > 10_000);
    for (_, value) in readings {
        let steps = value / 0.1;
        assert!((steps - steps.round()).abs() < 1e-3, "{value}");
    }
}

#[test]
fn an_estimate_gets_a_measurement_in_each_cell() {
    for table in ["[accelerometer]\n", "[accelerometer]\nmessage = \"VDC2\"\n"] {
        let run = run(&[table, MILD, A]);
        let mut estimator: Estimator<f32> =
            Estimator::new(run.vehicle.model.clone(), Tuning::default()).unwrap();
        let (mut cells, mut measured) = (0, 0);
        for timed in &run.frames {
            estimator.on_frame(timed.time, &timed.frame);
            while let Some(step) = estimator.step() {
                if step == Step::Smoothed {
                    continue;
                }
                let sample = estimator.sample().unwrap();
                cells += 1;
                measured += usize::from(sample.inertial.is_some());
            }
            while estimator.next_cell().is_some() {}
        }
        assert!(
            cells > 1_900 && measured >= cells - 1,
            "{measured} of {cells}"
        );
    }
}

#[test]
fn every_key_has_its_default_and_its_range() {
    let all = "[accelerometer]\nmessage = \"ACCS\"\nperiod_ms = 20.0\noffset_mps2 = 0.1\n\
        drift_mps2 = 0.02\nscale_factor = 1.01\nmounting_deg = 0.2\n\
        body_pitch_deg_per_mps2 = 0.3\nroughness_mps2 = 0.3\n\
        [pitch]\nmessage = \"SSI\"\nperiod_ms = 20.0\noffset_deg = 0.2\ndrift_deg = 0.05\n\
        body_pitch_deg_per_mps2 = 0.3\nnoise_sigma_deg = 0.1\n";
    let (stated, default) = (
        scenario(&[all, MILD, A]),
        scenario(&["[accelerometer]\n[pitch]\n", MILD, A]),
    );
    let tables = |of: &Scenario| format!("{:?} {:?}", of.accelerometer, of.pitch);
    assert_eq!(tables(&stated), tables(&default));
    for line in all.lines().filter(|line| line.contains(" = ")) {
        let (key, _) = line.split_once(" = ").unwrap();
        let table = if all.find(line) < all.find("[pitch]") {
            "accelerometer"
        } else {
            "pitch"
        };
        for wrong in ["1e9", "\"SSI3\"", "nan"] {
            let text = format!("[{table}]\n{key} = {wrong}\n{MILD}{A}");
            let error = Scenario::parse(&text, Path::new("s.toml")).unwrap_err();
            let words = error.to_string();
            assert!(words.contains(key), "{words}");
        }
    }
    let unknown = format!("[accelerometer]\nbias = 1.0\n{MILD}{A}");
    let error = Scenario::parse(&unknown, Path::new("s.toml")).unwrap_err();
    assert!(error.to_string().contains("bias"), "{error}");
}
