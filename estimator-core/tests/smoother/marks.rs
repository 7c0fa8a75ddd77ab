//! Marks of cells in which signals disagree.

use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS};
use estimator_core::{Disagreement, Tuning};
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

#[test]
fn a_union_has_each_kind_that_either_has() {
    let each = |kind: usize| {
        let is = |of: usize| of == kind;
        Disagreement {
            climb: is(0),
            brake: is(1),
            torque: is(2),
            speed: is(3),
            gear: is(4),
        }
    };
    let none = Disagreement::default();
    assert!(none.is_none() && none.or(none).is_none());
    for a in 0..Disagreement::KINDS {
        for b in 0..Disagreement::KINDS {
            let expected: Vec<bool> = (0..Disagreement::KINDS)
                .map(|kind| kind == a || kind == b)
                .collect();
            assert_eq!(each(a).or(each(b)).kinds(), expected[..], "{a} {b}");
        }
        assert_eq!(each(a).or(none), each(a));
        assert!(!each(a).is_none());
    }
}
