//! The smoothed run: what the recorder writes, and a run of several pieces.

use estimator_core::sample::Sample;
use estimator_core::{Context, Tuning};
use host_sim::recorder::Recorder;
use host_sim::smooth::{Known, SmoothedCell, smooth_run};
use test_kit::{altitude, sample, simulated, speed, truck};

#[test]
fn the_rows_of_a_run_are_its_smoothed_cells() {
    let run = simulated::run(&[
        "seed = 3\n[road]\nlength_m = 8000.0\n[gnss]\naltitude_sigma_m = 2.0\n\
         [[runs]]\nname = \"x\"\ntruck = \"A\"\n",
    ]);
    let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default()).unwrap();
    for frame in &run.frames {
        recorder.on_frame(frame);
    }
    let context = recorder.estimator().context().clone();
    let (found, samples) = recorder.finish_with_samples().unwrap();
    let expected = smooth_run(&context, Known::default(), &samples);
    assert_eq!(found.rows.len(), expected.len());
    for (row, cell) in found.rows.iter().zip(expected) {
        let estimate = cell.estimate;
        assert_eq!(row.distance_m, cell.end.distance_m());
        assert_eq!(row.grade_percent, f64::from(estimate.grade_percent.value));
        let sigma = estimate.grade_percent.sigma;
        assert_eq!(row.grade_sigma_percent, f64::from(sigma));
        let altitude_m = estimate.altitude_m.map(|z| z.value.into());
        assert_eq!(row.altitude_m, altitude_m);
        assert_eq!(row.speed_mps, f64::from(estimate.speed_mps));
        assert_eq!(row.bias_percent, f64::from(estimate.bias_percent.value));
        assert_eq!(row.scale, f64::from(estimate.scale.value));
        assert_eq!(row.mass_kg, Some(estimate.mass_kg.value.into()));
        assert_eq!(row.consistent == 1, cell.is_consistent);
    }
}

/// Slope of a hill of 2 km in a cell, and altitude at its end.
fn hill(cell: u32) -> (f32, f32) {
    let angle = (cell % 800) as f32 * (core::f32::consts::TAU / 800.0);
    (0.02 * angle.sin(), 100.0 - 6.366 * angle.cos())
}

fn hills(cells: u32) -> Vec<SmoothedCell> {
    let samples: Vec<Sample> = (0..cells)
        .map(|cell| {
            let (slope, altitude_m) = hill(cell);
            let force_n = 3_926.0 + 39_000.0 * 9.806_65 * slope;
            let mut sample = sample(cell, force_n, 20.0);
            sample.speed = speed(20.0);
            if cell % 8 == 0 {
                sample.altitude = altitude(altitude_m);
            }
            sample
        })
        .collect();
    let context = Context::new(truck(), Tuning::default()).unwrap();
    smooth_run(&context, Known::default(), &samples)
}

#[test]
fn a_run_of_two_pieces_has_no_seam() {
    // A piece is 40,000 cells.
    let cells = hills(43_000);
    assert_eq!(cells.len(), 43_000);
    let mut last = None;
    for (number, cell) in cells.iter().enumerate() {
        assert_eq!(cell.end.cell as usize, number);
        let grade = cell.estimate.grade_percent.value;
        let step = last.map_or(0.0, |last: f32| (grade - last).abs());
        assert!(step < 0.03, "a step of {step} % at cell {number}");
        last = Some(grade);
        let error = grade - 100.0 * hill(number as u32).0;
        let is_inner = (400..42_600).contains(&number);
        assert!(!is_inner || error.abs() < 0.06, "{error} % at {number}");
    }
}
