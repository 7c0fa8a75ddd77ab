//! The load of a vehicle whose mass no signal reports. A launch shows it. The climbs of a drive that
//! begins in motion show it too. Forces, speeds and altitudes are those of a vehicle of known mass.

use estimator_core::filter::{ModelMass, StateIndex};
use estimator_core::sample::Sample;
use estimator_core::{CELL_LENGTH_M, Tuning};
use test_kit::{FilterRun, FilteredStep, Noise, altitude, sample, speed, truck};

const GRAVITY: f64 = 9.806_65;
/// Mass of the file, and what rotating parts add, kg.
const FILE_KG: f64 = 39_000.0;
const TURNING_KG: f64 = 500.0;

/// Returns the air resistance for a squared speed, N.
fn air_n(square_mps: f64) -> f64 {
    0.5 * f64::from(truck().drag_area_m2) * 1.2 * square_mps
}

/// Returns a launch on a level road from a standstill over so many cells: 45 kN at most and 260 kW,
/// without traction in each gear shift.
fn launch(true_kg: f64, cells: u32) -> Vec<Sample> {
    let rolling_n = f64::from(truck().rolling_resistance) * true_kg * GRAVITY;
    let mut energy = 0.2;
    (1..=cells)
        .map(|k| {
            let start_mps = f64::sqrt(2.0 * energy);
            let shifts = k % 15 == 14;
            let force_n = if shifts {
                0.0
            } else {
                // The clutch closes over the first cells.
                (260_000.0 / start_mps).min(45_000.0) * f64::from(k.min(4)) / 4.0
            };
            let net_n = force_n - air_n(2.0 * energy) - rolling_n;
            energy += net_n / (true_kg + TURNING_KG) * f64::from(CELL_LENGTH_M);
            let mps = f64::sqrt(2.0 * energy) as f32;
            let mut sample = sample(k, force_n as f32, mps);
            sample.end.condition.shifting = shifts;
            sample.speed = speed(mps);
            sample
        })
        .collect()
}

/// Returns the steps of a drive, and how far the gross mass of each is off, as a part of it.
fn driven(samples: &[Sample], true_kg: f64, tuning: &Tuning) -> Vec<(FilteredStep<f64>, f64)> {
    let mut run = FilterRun::<f64>::new(truck(), tuning.clone());
    samples
        .iter()
        .map(|sample| {
            let step = run.step(sample).expect("every sample has a speed");
            let mass = ModelMass::of(&run.context, sample);
            let found_kg = f64::from(step.state.estimate(&mass).mass_kg.value);
            (step, found_kg / true_kg - 1.0)
        })
        .collect()
}

/// Factors from the mass of the file to the true one.
const WRONG: [f64; 2] = [0.5, 2.0];

/// Returns a launch over so many metres by [`driven`]: so many times the mass of the file.
fn launched(factor: f64, metres: u32, tuning: &Tuning) -> Vec<(FilteredStep<f64>, f64)> {
    let true_kg = factor * FILE_KG;
    driven(&launch(true_kg, metres * 2 / 5), true_kg, tuning)
}

/// Returns the tuning without launches.
fn without_launches() -> Tuning {
    let mut tuning = Tuning::default();
    tuning.process_noise.launch_mps2 = 10.0;
    tuning
}

/// At a launch, all of a change of traction shows the scale. Elsewhere only what no road can have
/// caused does: at a launch, the rest would then be missing.
#[test]
fn a_launch_shows_the_scale_within_100_m() {
    let tuning = Tuning::default();
    let least = f64::from(tuning.process_noise.jump_scale_sigma);
    for factor in WRONG {
        let (last, off) = *launched(factor, 100, &tuning).last().unwrap();
        let sigma = last.state.sigma(StateIndex::Scale) * factor;
        assert!(off.abs() < 0.02, "{factor}: {off}");
        assert!((0.95 * least..0.15).contains(&sigma), "{factor}: {sigma}");
        let (_, off) = *launched(factor, 100, &without_launches()).last().unwrap();
        assert!(off.abs() > 0.1, "{factor}: {off}");
    }
    // A file that is right stays right.
    for (_, off) in launched(1.0, 3_000, &tuning) {
        assert!(off.abs() < 0.01, "{off}");
    }
}

/// Each change of a launch counts, also those behind the comparison with the load of the file.
#[test]
fn a_scale_that_a_launch_has_shown_stays() {
    for factor in WRONG {
        let cells = launched(factor, 3_000, &Tuning::default());
        for (step, off) in &cells[39..] {
            let cell = step.record.end.cell;
            assert!(off.abs() < 0.05, "{factor}, cell {cell}: {off}");
        }
    }
}

#[test]
fn a_scale_that_a_launch_has_shown_stays_while_it_is_not_compared() {
    let mut tuning = Tuning::default();
    tuning.prior.launch_m = tuning.prior.launch_longest_m;
    for factor in WRONG {
        for (step, off) in &launched(factor, 3_000, &tuning)[39..] {
            let cell = step.record.end.cell;
            assert!(off.abs() < 0.02, "{factor}, cell {cell}: {off}");
        }
    }
}

#[test]
fn a_drive_that_begins_in_motion_has_no_launch() {
    let true_kg = 0.5 * FILE_KG;
    let samples = launch(true_kg, 120);
    let coast_mps = Tuning::default().detection.coast_mps;
    let begins = samples
        .iter()
        .position(|sample| sample.end.speed_mps >= coast_mps)
        .expect("it gains speed");
    for (from, same) in [(begins, true), (0, false)] {
        let found = |tuning: &Tuning| driven(&samples[from..], true_kg, tuning);
        let is_same = found(&Tuning::default()) == found(&without_launches());
        assert_eq!(is_same, same, "from cell {from}");
    }
}

/// Returns 10 km over hills of 2 % at 20 m/s, begun in motion.
fn hills(true_kg: f64, seed: u64) -> Vec<Sample> {
    let (mut reading, mut fix) = (Noise(seed), Noise(seed + 100));
    (1..=4_000_u32)
        .map(|k| {
            let angle = f64::from(k) * f64::from(CELL_LENGTH_M) * core::f64::consts::TAU / 1_000.0;
            let rolling = f64::from(truck().rolling_resistance);
            let force_n = air_n(400.0) + true_kg * GRAVITY * (rolling + 0.02 * angle.sin());
            let mut sample = sample(k, force_n as f32, 20.0);
            sample.speed = speed(20.0 + 0.013 * reading.draw());
            if k % 8 == 0 {
                let height_m = -0.02 * 1_000.0 / core::f64::consts::TAU * angle.cos();
                sample.altitude = altitude(100.0 + height_m as f32 + 0.5 * fix.draw());
            }
            sample
        })
        .collect()
}

#[test]
fn the_load_of_a_drive_that_begins_in_motion_is_found_within_10_km() {
    let tuning = Tuning::default();
    let mut closed = tuning.clone();
    closed.prior.unreported_scale_sigma = 1e-4;
    closed.prior.scale_reset_cells = 1_000_000;
    for factor in WRONG {
        let true_kg = factor * FILE_KG;
        for seed in 1..=4 {
            let samples = hills(true_kg, seed);
            let cells = driven(&samples, true_kg, &tuning);
            let off = |metres: usize| cells[metres * 2 / 5 - 1].1;
            assert!(off(10_000).abs() < 0.05, "{factor}: {}", off(10_000));
            assert!(off(4_000).abs() < 0.1, "{factor}: {}", off(4_000));
            let sigma = cells[3_999].0.state.sigma(StateIndex::Scale) * factor;
            assert!(off(10_000).abs() < 3.0 * sigma, "{factor}: ± {sigma}");
            // The prior of a file that is right would hold it back.
            let held = driven(&samples[..1_600], true_kg, &closed)[1_599].1;
            assert!(held.abs() > 0.15, "{factor}: {held}");
        }
    }
}

#[test]
fn a_load_that_nothing_tells_is_taken_for_that_of_before_after_twenty_kilometres() {
    // At a steady speed on a level road every load fits.
    let force_n = air_n(400.0) + f64::from(truck().rolling_resistance) * FILE_KG * GRAVITY;
    let samples: Vec<_> = (1..=9_000)
        .map(|cell| {
            let mut sample = sample(cell, force_n as f32, 20.0);
            sample.speed = speed(20.0);
            sample
        })
        .collect();
    let steps = driven(&samples, FILE_KG, &Tuning::default());
    let sigma = |cell: usize| steps[cell].0.state.sigma(StateIndex::Scale);
    // 20 km are 8,000 cells.
    assert!(sigma(7_990) > 0.2, "{}", sigma(7_990));
    assert!(sigma(8_010) < 0.5 * sigma(7_990), "{}", sigma(8_010));
}

/// The road does not know of the load. The slope that the model reads depends on both, so the net
/// traction of before the stop must not count behind it.
#[test]
fn the_slope_of_the_road_is_as_certain_behind_a_stop_as_before() {
    let mut samples = hills(FILE_KG, 5);
    let stop = samples.len() / 2 + 100;
    samples[stop].after_stop = true;
    samples[stop].end.condition.shifting = true;
    let cells = driven(&samples[..=stop], FILE_KG, &Tuning::default());
    let [before, behind] = [stop - 1, stop].map(|cell| cells[cell].0.state);
    assert!(before.net_traction > 1.0, "{}", before.net_traction);
    let [before, behind] = [before, behind].map(|state| state.estimate(&ModelMass::default()));
    assert!(behind.scale.sigma > 10.0 * before.scale.sigma, "{behind:?}");
    let [before, behind] = [before, behind].map(|estimate| estimate.grade_percent);
    assert!(
        (behind.value - before.value).abs() < 0.05,
        "{before:?}, {behind:?}"
    );
    assert!(behind.sigma < 1.1 * before.sigma, "{before:?}, {behind:?}");
}
