//! The filter and its smoothing in fixed point against double precision.

use estimator_core::filter::ModelMass;
use estimator_core::sample::Sample;
use estimator_core::{
    Estimate, Estimator, FixedPoint, Instant, Reading, Signal, Traction, Tuning, Uncertain, Value,
};
use std::iter::from_fn;
use test_kit::{
    FilterRun, FilteredStep, Noise, altitude, cells, run, sample, smooth, speed, truck,
};

/// Returns a drive with a gap, missing speeds, an altitude step, brakes, crawling and standstill.
fn drive() -> Vec<Sample> {
    let mut noise = Noise(5);
    (1..=1_500_u32)
        .map(|k| {
            let mps = if (900..950).contains(&k) { 0.2 } else { 20.0 };
            let mut s = sample(k, 9_000.0 + 4_000.0 * noise.draw(), mps);
            if k == 1 || k % 7 != 0 {
                s.speed = speed((mps + 0.02 * noise.draw()).max(0.0));
            }
            if k % 9 == 4 {
                let step = if k > 250 { 25.0 } else { 0.0 };
                s.altitude = altitude(100.0 + step + 0.5 * noise.draw());
            }
            if k == 333 {
                s.gap_cells = 3;
                s.speed = speed(20.0);
            }
            s.after_load_change = k == 951;
            s.end.condition.braking = k % 97 < 9;
            s
        })
        .collect()
}

fn assert_near(fixed: Uncertain, double: Uncertain) {
    // Where a sigma is large, rounding moves the value by a small part of it.
    let off = fixed.value - double.value;
    assert!(
        off.abs() < 1e-4 * (1.0 + double.value.abs()) + 5e-4 * double.sigma,
        "{fixed:?} {double:?}"
    );
    let ratio = fixed.sigma / double.sigma;
    assert!((ratio - 1.0).abs() < 2e-3, "{fixed:?} {double:?}");
}

#[test]
fn every_estimate_is_that_of_double_precision() {
    let tuning = Tuning::default();
    let (fixed, double) = (
        run::<FixedPoint>(&drive(), &tuning),
        run::<f64>(&drive(), &tuning),
    );
    assert_eq!(fixed.len(), double.len());
    for (fixed, double) in cells(&fixed).iter().zip(cells(&double)) {
        assert_eq!(fixed.end, double.end);
        assert_near(fixed.live_grade_percent, double.live_grade_percent);
        assert_near(fixed.lagged_grade_percent, double.lagged_grade_percent);
        if let (Some(fixed), Some(double)) = (fixed.altitude_m, double.altitude_m) {
            // The altitude is off by hundreds of metres by then.
            assert!((fixed.value - double.value).abs() < 5e-3);
            assert!((fixed.sigma / double.sigma - 1.0).abs() < 2e-3);
        }
    }
    let live = |cell: &FilteredStep<FixedPoint>| cell.state.estimate(&ModelMass::default());
    let estimates: Vec<Estimate> = fixed.iter().map(live).collect();
    for (found, of) in [(estimates, 0), (smooth(&fixed), 1)] {
        let double: Vec<Estimate> = match of {
            0 => double
                .iter()
                .map(|cell| cell.state.estimate(&ModelMass::default()))
                .collect(),
            _ => smooth(&double),
        };
        for (fixed, double) in found.iter().zip(&double) {
            assert_near(fixed.grade_percent, double.grade_percent);
            assert_near(fixed.bias_percent, double.bias_percent);
            assert_near(fixed.scale, double.scale);
            // The state is energy, which a step of the speed changes by 200 m²/s².
            let energy = |estimate: &Estimate| 0.5 * estimate.speed_mps.powi(2);
            assert!((energy(fixed) - energy(double)).abs() < 0.01);
        }
    }
}

/// A force that no truck has makes the state overflow. The overflow is counted, and the filter
/// restarts.
#[test]
fn an_overflow_is_counted_and_restarts_the_filter() {
    let mut run = FilterRun::<FixedPoint>::new(truck(), Tuning::default());
    for k in 1..=400_u32 {
        let mut s = sample(k, if k == 200 { 1e16 } else { 9_000.0 }, 20.0);
        s.speed = speed(20.0);
        let cell = run.step(&s);
        assert_eq!(cell.is_none(), k == 200, "{k}");
        if let Some(cell) = cell {
            assert!(cell.state.is_sound());
            assert!(
                cell.state
                    .estimate(&ModelMass::default())
                    .grade_percent
                    .value
                    .abs()
                    < 10.0
            );
        }
    }
    assert_eq!(run.context.counters.restarts, 1);
}

/// By readings, as a program would: every fetched number is finite, for any input.
#[test]
fn an_estimator_returns_finite_numbers_only() {
    let mut vehicle = truck();
    vehicle.traction = Traction::Force;
    let mut estimator = Estimator::<FixedPoint>::new(vehicle, Tuning::default()).unwrap();
    let mut cells = 0;
    for k in 0..4_000_u64 {
        let now = Instant::from_micros(k * 100_000);
        let force_n = if k % 500 == 499 { f32::MAX } else { 5_000.0 };
        for (signal, value) in [(Signal::TractionForce, force_n), (Signal::WheelSpeed, 20.0)] {
            let value = Value::Real(value);
            estimator.on_reading(now, Reading { signal, value });
        }
        while estimator.step().is_some() {
            if let Some(live) = estimator.live() {
                assert!(live.estimate.grade_percent.value.is_finite());
                assert!(live.estimate.grade_percent.sigma.is_finite());
            }
            cells += from_fn(|| estimator.next_cell()).count();
        }
    }
    cells += from_fn(|| estimator.drain_cell()).count();
    let counters = estimator.counters();
    assert!(counters.restarts > 0, "the largest force overflows");
    assert_eq!(counters.steps, cells as u32 + counters.restarts);
    assert_eq!(counters.cells_unsound, 0);
}
