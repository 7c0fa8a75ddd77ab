//! The scale stays within what loads can make of it, whatever altitudes say.

use estimator_core::Tuning;
use estimator_core::filter::StateIndex::Scale;
use estimator_core::sample::Sample;
use test_kit::{FilteredStep, altitude, cells, run_counted, sample, smooth, speed};

/// A drive of 10 km over hills of 2 %, of which the receiver reports so many times the height.
fn hills(times: f32) -> Vec<Sample> {
    (1..=4_000_u16)
        .map(|cell| {
            let angle = f32::from(cell) * (2.5 / 1_000.0 * core::f32::consts::TAU);
            let force_n = 3_926.0 + 39_000.0 * 9.806_65 * 0.02 * angle.sin();
            let mut sample = sample(cell.into(), force_n, 20.0);
            sample.speed = speed(20.0);
            if cell % 8 == 0 {
                sample.altitude = altitude(100.0 - 3.183 * times * angle.cos());
            }
            sample
        })
        .collect()
}

/// Returns the smallest and the largest scale after a step, and those of the smoothed ones.
fn scales(times: f32) -> ([f64; 2], [f64; 2]) {
    let (cells, _) = run_counted::<f64>(&hills(times), &Tuning::default());
    let extent = |scales: Vec<f64>| {
        let low = scales.iter().copied().fold(f64::INFINITY, f64::min);
        let high = scales.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    };
    let filtered = cells.iter().map(|cell| 1.0 + cell.state.mean[Scale]);
    let smoothed = smooth(&cells);
    let smoothed = smoothed
        .iter()
        .map(|estimate| f64::from(estimate.scale.value));
    (extent(filtered.collect()), extent(smoothed.collect()))
}

#[test]
fn absurd_altitudes_do_not_move_it_beyond_any_load() {
    let tuning = Tuning::default().prior;
    let (low, high) = (f64::from(tuning.scale_low), f64::from(tuning.scale_high));
    for times in [-4.0, -1.0, 0.0, 8.0, 30.0] {
        let (filtered, smoothed) = scales(times);
        assert!(
            filtered[0] >= low - 1e-6 && filtered[1] <= high + 1e-6,
            "{times}: {filtered:?}"
        );
        // Before it is set to its bound, a single altitude may move it further. No grade is inverted.
        assert!(
            smoothed[0] > 0.0 && smoothed[1] < 3.0 * high,
            "{times}: {smoothed:?}"
        );
    }
}

#[test]
fn a_scale_that_is_set_to_its_bound_is_lagged_as_it_is_smoothed() {
    let filtered = run_counted::<f64>(&hills(-4.0), &Tuning::default()).0;
    let smoothed = smooth(&filtered);
    // What is drained at the end is smoothed by all that follows.
    let last = filtered.len() - 200;
    let set = |cell: &FilteredStep<f64>| cell.record.smoother_input.scale_set;
    assert!(filtered[last..].iter().any(set));
    for (cell, estimate) in cells(&filtered).iter().zip(&smoothed).skip(last) {
        let (lagged, whole) = (cell.lagged_grade_percent, estimate.grade_percent);
        assert!(
            (lagged.value - whole.value).abs() < 1e-3,
            "{lagged:?} {whole:?}"
        );
        assert!(
            (lagged.sigma / whole.sigma - 1.0).abs() < 1e-3,
            "{lagged:?} {whole:?}"
        );
    }
}

#[test]
fn possible_altitudes_are_believed() {
    for times in [0.5, 1.0, 2.5] {
        let found = run_counted::<f64>(&hills(times), &Tuning::default());
        let last = found.0.last().unwrap().state.mean[Scale] + 1.0;
        assert!(
            (last / f64::from(times) - 1.0).abs() < 0.1,
            "{times}: {last}"
        );
        assert_eq!(found.1.scales_out_of_bounds, 0);
    }
}
