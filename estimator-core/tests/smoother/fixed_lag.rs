//! Fixed-lag smoothing against a backward pass over all of its records.

use estimator_core::Tuning;
use estimator_core::filter::ModelMass;
use estimator_core::sample::{AltitudeContinuity, Sample};
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS};
use estimator_core::smoother::{BackwardPass, FixedLag};
use std::iter::from_fn;
use test_kit::{Noise, altitude, cells, run, sample, speed};

/// Returns a drive with all interruptions of a chain of cells: a gap, a new datum, a step of the
/// GNSS error, missing speeds and altitudes.
fn drive() -> Vec<Sample> {
    let mut noise = Noise(5);
    (1..=700_u32)
        .map(|k| {
            let mut s = sample(k, 9_000.0 + 4_000.0 * noise.draw(), 20.0);
            if k == 1 || k % 7 != 0 {
                s.speed = speed(20.0 + 0.02 * noise.draw());
            }
            if k % 9 == 4 {
                let datum = if k > 420 { 140.0 } else { 100.0 };
                let step = if k > 250 { 25.0 } else { 0.0 };
                s.altitude = altitude(datum + step + 0.5 * noise.draw());
                if let Some(altitude) = s.altitude.as_mut().filter(|_| k == 427) {
                    altitude.continuity = AltitudeContinuity::Switched;
                }
            }
            if k == 333 {
                s.gap_cells = 3;
                s.speed = speed(20.0);
            }
            s.end.condition.braking = k % 97 < 9;
            s
        })
        .collect()
}

#[test]
fn a_cell_is_smoothed_by_its_lag_and_no_more() {
    let filtered = run::<f64>(&drive(), &Tuning::default());
    let cells = cells(&filtered);
    assert_eq!(cells.len(), filtered.len());
    for (k, cell) in cells.iter().enumerate() {
        assert_eq!(cell.end, filtered[k].record.end);
        let live = filtered[k]
            .state
            .estimate(&ModelMass::default())
            .grade_percent;
        assert_eq!(cell.live_grade_percent, live);
        // The lag of a block begins at its end.
        let block_end = (k / BLOCK_CELLS + 1) * BLOCK_CELLS;
        let seen = (block_end + LAG_CELLS).min(filtered.len());
        let mut pass = BackwardPass::new();
        for later in filtered[k + 1..seen].iter().rev() {
            pass.retreat(&later.record.smoother_input);
        }
        let direct = pass
            .estimate(&filtered[k].state, &ModelMass::default())
            .grade_percent;
        let lagged = cell.lagged_grade_percent;
        assert!(
            (lagged.value - direct.value).abs() < 1e-5 * (1.0 + direct.value.abs()),
            "{k}: {lagged:?} {direct:?}"
        );
        assert!((lagged.sigma / direct.sigma - 1.0).abs() < 1e-5, "{k}");
        assert!(lagged.sigma <= live.sigma * 1.000_001);
    }
}

#[test]
fn single_precision_follows_double() {
    let drive = drive();
    let tuning = Tuning::default();
    let single = cells(&run::<f32>(&drive, &tuning));
    let double = cells(&run::<f64>(&drive, &tuning));
    for (a, b) in single.iter().zip(&double) {
        let (a, b) = (a.lagged_grade_percent, b.lagged_grade_percent);
        assert!((a.value - b.value).abs() < 2e-3, "{a:?} {b:?}");
        assert!((a.sigma / b.sigma - 1.0).abs() < 2e-3, "{a:?} {b:?}");
    }
}

#[test]
fn cells_that_are_not_fetched_are_reported() {
    let mut lag = FixedLag::new();
    let filtered = run::<f32>(&drive(), &Tuning::default());
    let lost: usize = filtered
        .iter()
        .map(|cell| lag.push(&cell.record, &cell.state))
        .sum();
    let drained = from_fn(|| lag.drain_cell()).count();
    assert!(lost > 0);
    assert_eq!(lost + drained, filtered.len());
}
