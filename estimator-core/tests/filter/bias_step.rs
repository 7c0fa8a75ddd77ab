//! Steps of the model's error, as the backward pass over a drive finds them.

use super::model_doubt::{FROM, drive};
use estimator_core::filter::StateIndex::{Bias, Slope};
use estimator_core::smoother::BackwardPass;
use estimator_core::{Tuning, Uncertain};
use test_kit::{FilterRun, sample, speed, truck};

/// Returns the most significant step of a drive, its test ratio and the cell at whose end it is.
fn largest(resistance_percent: f32) -> (f32, Uncertain, u32) {
    let mut pass = BackwardPass::new();
    let mut largest = (0.0, Uncertain::default(), 0);
    for step in drive(resistance_percent, Tuning::default()).iter().rev() {
        let found = pass.bias_step();
        let test_ratio = (found.value / found.sigma).powi(2);
        if test_ratio > largest.0 {
            largest = (test_ratio, found, step.record.end.cell);
        }
        pass.retreat(&step.record.smoother_input);
    }
    largest
}

#[test]
fn a_backward_pass_finds_the_cell_and_the_size_of_a_step() {
    for resistance_percent in [0.3, 0.5, -0.5] {
        let (test_ratio, step, cell) = largest(resistance_percent);
        let what = format!("{resistance_percent} %: {test_ratio} {step:?} {cell}");
        assert!(test_ratio > 25.0, "{what}");
        assert!(cell.abs_diff(FROM) <= 20, "{what}");
        // The missing resistance is a slope that the model reads too high.
        let error = step.value - resistance_percent;
        assert!(error.abs() < 0.5 * resistance_percent.abs(), "{what}");
    }
}

#[test]
fn a_drive_without_a_step_has_none() {
    let (test_ratio, step, cell) = largest(0.0);
    assert!(test_ratio < 9.0, "{test_ratio} {step:?} {cell}");
}

#[test]
fn nothing_later_is_no_step() {
    let step = BackwardPass::<f64>::new().bias_step();
    assert_eq!(step.value, 0.0);
    assert_eq!(step.sigma, f32::INFINITY);
}

#[test]
fn a_step_that_is_allowed_for_moves_no_road() {
    let tuning = Tuning::default();
    let mut run = FilterRun::<f64>::new(truck(), tuning.clone());
    // Before the first speed there is nothing to allow for.
    run.filter.allow_step(&tuning);
    assert!(run.filter.state().is_none());
    for k in 1..=200 {
        let mut sample = sample(k, 5_000.0, 20.0);
        sample.speed = speed(20.0);
        run.step(&sample);
    }
    let before = *run.filter.state().unwrap();
    run.filter.allow_step(&tuning);
    let after = run.filter.state().unwrap();
    assert_eq!(before.mean, after.mean);
    let added = |i, j| after.covariance.get(i, j) - before.covariance.get(i, j);
    let variance = f64::from(tuning.gates.slope_step_percent.powi(2));
    for (i, j, expected) in [
        (Bias, Bias, variance),
        (Slope, Bias, variance),
        // The road may have a kink there, too.
        (Slope, Slope, 2.0 * variance),
    ] {
        assert!((added(i, j) - expected).abs() < 1e-6, "{i:?} {j:?}");
    }
}
