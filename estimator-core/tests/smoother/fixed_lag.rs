//! Fixed-lag smoothing against a backward pass over all of its records.

use estimator_core::filter::{ModelMass, Quantity};
use estimator_core::sample::{AltitudeContinuity, Sample};
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS, SHARES, bytes};
use estimator_core::smoother::{BackwardPass, BlockSmoother, FixedLag};
use estimator_core::{Cell, Tuning, Uncertain};
use std::iter::from_fn;
use test_kit::{FilteredStep, Noise, altitude, cells, run, sample, speed};

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

/// Returns grade and altitude of each cell, each block smoothed and finished at once.
fn blockwise(filtered: &[FilteredStep<f32>]) -> Vec<(Uncertain, Option<Uncertain>)> {
    let mut smoothers = Vec::new();
    let mut pending = Vec::new();
    for block in filtered.chunks(BLOCK_CELLS) {
        let mut smoother = BlockSmoother::new();
        let mut cells = Vec::new();
        for step in block.iter().rev() {
            let altitude = step.state.quantity(Quantity::Altitude);
            let altitude = smoother.within().smooth(&altitude);
            let slope = smoother.smooth(&step.state.quantity(Quantity::Slope));
            cells.push((slope, altitude.altitude(step.state.origin_m)));
            smoother.retreat(&step.record.smoother_input);
        }
        smoothers.push(smoother);
        pending.push(cells);
    }
    let mut finished = Vec::new();
    for (n, cells) in pending.iter().enumerate() {
        let last = (n + LAG_CELLS / BLOCK_CELLS).min(smoothers.len() - 1);
        let mut pass = BackwardPass::new();
        for later in smoothers[n + 1..=last].iter().rev() {
            later.retreat_through(&mut pass);
        }
        let cells = cells.iter().rev();
        finished.extend(cells.map(|(slope, altitude)| (pass.smooth(slope).grade(), *altitude)));
    }
    finished
}

#[test]
fn shares_of_work_give_the_numbers_of_whole_blocks() {
    let filtered = run::<f32>(&drive(), &Tuning::default());
    let whole = blockwise(&filtered);
    // The end of the drive at each stage of the work.
    for steps in 640..=filtered.len() {
        let cells = cells(&filtered[..steps]);
        let expected = if steps == filtered.len() {
            whole.clone()
        } else {
            blockwise(&filtered[..steps])
        };
        assert_eq!(cells.len(), steps);
        for (cell, (grade, altitude)) in cells.iter().zip(expected) {
            assert_eq!(cell.lagged_grade_percent, grade);
            assert_eq!(cell.altitude_m, altitude);
        }
    }
}

#[test]
fn cells_come_at_most_a_block_after_their_lag() {
    let filtered = run::<f32>(&drive(), &Tuning::default());
    let mut lag = FixedLag::new();
    let mut finished = 0;
    for (step, cell) in (1..).zip(&filtered) {
        assert_eq!(lag.push(&cell.record, &cell.state), 0);
        let cells = from_fn(|| lag.next_cell()).count();
        finished += cells;
        assert!(cells == 0 || step >= LAG_CELLS + BLOCK_CELLS + SHARES);
        // All blocks whose lag was over a block ago.
        let due = (step - SHARES.min(step)) / BLOCK_CELLS * BLOCK_CELLS;
        assert_eq!(finished, due.saturating_sub(LAG_CELLS), "after {step}");
    }
}

#[test]
fn a_drive_ends_in_shares_of_work() {
    let filtered = run::<f32>(&drive(), &Tuning::default());
    for steps in [1, 19, 20, 21, 231, 333, 700] {
        let at_once = cells(&filtered[..steps]);
        let mut lag = FixedLag::new();
        let mut fetched: Vec<Cell> = Vec::new();
        for step in &filtered[..steps] {
            lag.push(&step.record, &step.state);
            fetched.extend(from_fn(|| lag.next_cell()));
        }
        while let Some(lost) = lag.drain_step() {
            assert_eq!(lost, 0);
            fetched.extend(from_fn(|| lag.next_cell()));
        }
        assert_eq!(fetched, at_once);
    }
}

#[test]
fn what_follows_the_end_of_a_drive_is_smoothed_as_a_drive_of_its_own() {
    let filtered = run::<f32>(&drive(), &Tuning::default());
    let (first, second) = filtered.split_at(313);
    let mut lag = FixedLag::new();
    let mut fetched: Vec<Cell> = Vec::new();
    for drive in [first, second] {
        for step in drive {
            lag.push(&step.record, &step.state);
            fetched.extend(from_fn(|| lag.next_cell()));
        }
        fetched.extend(from_fn(|| lag.drain_cell()));
    }
    let expected = [cells(first), cells(second)].concat();
    assert_eq!(fetched, expected);
}

#[test]
fn the_memory_of_a_lag_is_what_it_is_said_to_be() {
    fn check<S>() {
        let lag_blocks = LAG_CELLS / BLOCK_CELLS;
        let (said, taken) = (bytes::<S>(lag_blocks), size_of::<FixedLag<S>>());
        // The queues beside, with the work that is under way: less than a block of it.
        assert!(said <= taken && taken < said + said / 20, "{said} {taken}");
        assert!(bytes::<S>(lag_blocks + 1) > said);
    }
    check::<f32>();
    check::<f64>();
}
