//! The speed where the forces are not known: while the clutch slips.

use estimator_core::filter::StateIndex;
use estimator_core::sample::{Sample, SpeedMeasurement};
use estimator_core::{CELL_LENGTH_M, Tuning};
use test_kit::{FilterRun, sample, truck};

/// What a clutch that slips makes of the torque, m/s².
const GAINED_MPS2: f32 = 2.0;
/// Cells between which it slips.
const SLIPS: (u32, u32) = (100, 125);

/// Returns the squared speed at the end of a cell, m²/s²: 4 m/s, and the clutch slips.
fn square_mps(cell: u32) -> f32 {
    let gained = cell.clamp(SLIPS.0, SLIPS.1) - SLIPS.0;
    16.0 + 2.0 * GAINED_MPS2 * gained as f32 * CELL_LENGTH_M
}

/// Returns a drive with so many readings in every cell, or with one in each of so many cells.
fn launched(count: u8, every: u32) -> Vec<Sample> {
    (1..=150)
        .map(|cell| {
            let [before, end] = [cell - 1, cell].map(|cell| square_mps(cell).sqrt());
            let duration_s = 2.0 * CELL_LENGTH_M / (before + end);
            let mut sample = sample(cell, 0.0, end);
            sample.duration_s = duration_s;
            sample.end.condition.shifting = (SLIPS.0 + 1..=SLIPS.1).contains(&cell);
            sample.speed = (cell % every == 1 % every).then(|| SpeedMeasurement {
                mean_mps: (0.5 * (square_mps(cell - 1) + square_mps(cell))).sqrt(),
                behind_m: 0.5 * CELL_LENGTH_M,
                count,
                resolution_mps: 0.0,
            });
            sample
        })
        .collect()
}

/// Returns by how much the speed is off at the end of each cell, m/s.
fn off_mps(samples: &[Sample]) -> Vec<(u32, f32)> {
    let mut run = FilterRun::<f64>::new(truck(), Tuning::default());
    let off = samples.iter().map(|sample| {
        let state = run.step(sample).expect("every sample has a speed").state;
        let energy = state.mean[StateIndex::KineticEnergy] as f32;
        let true_mps = square_mps(sample.end.cell).sqrt();
        (sample.end.cell, (2.0 * energy).sqrt() - true_mps)
    });
    off.collect()
}

/// The mean of the readings lies 1.25 m before the cell's end, over which the vehicle gains 0.2 to 0.6 m/s.
#[test]
fn a_clutch_that_slips_does_not_carry_the_speed_off() {
    for (cell, off) in off_mps(&launched(5, 1)) {
        if cell > SLIPS.0 {
            assert!(off.abs() < 0.05, "cell {cell}: {off} m/s");
        }
    }
}

/// A second apart, the speed between two readings is hardly better known.
#[test]
fn the_speed_between_sparse_readings_hardly_counts() {
    let sparse = launched(1, 8);
    let mut other = sparse.clone();
    for sample in &mut other[SLIPS.0 as usize..] {
        sample.end.speed_mps += 0.1;
    }
    for ((cell, a), (_, b)) in off_mps(&sparse).into_iter().zip(off_mps(&other)) {
        assert!((a - b).abs() < 0.01, "cell {cell}: {a} and {b} m/s");
    }
}
