//! Marks of cells in which signals disagree.

use estimator_core::Tuning;
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS};
use test_kit::{cells, run, sample, speed};

#[test]
fn a_disagreement_marks_its_cell_and_those_before_it_that_are_not_finished() {
    let samples: Vec<_> = (0..600)
        .map(|k| {
            let mut sample = sample(k, 5_000.0, 20.0);
            sample.speed = speed(20.0);
            sample
        })
        .collect();
    let mut filtered = run::<f32>(&samples, &Tuning::default());
    let (at, back) = (400, 50);
    filtered[at].record.disagreement.climb = true;
    filtered[at].record.disagreeing_cells = back;
    let cells = cells(&filtered);
    assert_eq!(cells.len(), filtered.len());
    // No vehicle knows at once what is noticed late.
    for (k, cell) in cells.iter().enumerate() {
        assert_eq!(cell.live_consistent, k != at, "{k}");
    }
    let marked: Vec<usize> = (0..cells.len())
        .filter(|k| !cells[*k].lagged_consistent)
        .collect();
    assert!(marked.contains(&at) && marked.contains(&(at + 1 - back as usize)));
    assert!(!marked.contains(&(at - back as usize)));
    // The marks end with the block of the cell.
    assert!(marked.len() <= back as usize + BLOCK_CELLS);
    const { assert!(LAG_CELLS >= 50) };
}
