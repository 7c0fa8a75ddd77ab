//! What an error of the place along the road does to the grade of a cell: the change of the grade
//! times that error.

use super::placing::PlacedCell;
use crate::map::geometry::grid::GRID_M;

/// Error of a run's place along the road, 1 sigma, m: slow errors of receivers of 1 to 2 m, and 0.03
/// s of unknown latency at 20 m/s.
const PLACE_SIGMA_M: f64 = 1.7;
/// Cells on either side over which the change of the grade is taken: 10 m. The profile of a run is
/// smooth over that.
const REACH_CELLS: usize = 4;

/// Adds to the variance of each cell what it owes to the error of its place.
pub(super) fn add_to(cells: &mut [PlacedCell]) {
    let added: Vec<f64> = (0..cells.len())
        .map(|i| (PLACE_SIGMA_M * change_per_m(cells, i)).powi(2))
        .collect();
    for (cell, variance) in cells.iter_mut().zip(added) {
        cell.grade_variance += variance;
    }
}

/// Returns the change of the grade along the road at a cell, % per m; 0 beside gaps.
fn change_per_m(cells: &[PlacedCell], i: usize) -> f64 {
    let is_joined = |j: usize| {
        let (here, there) = (&cells[i], &cells[j]);
        here.way == there.way && here.number.abs_diff(there.number) == i.abs_diff(j) as u64
    };
    let from = (0..=REACH_CELLS.min(i)).rev().find(|&n| is_joined(i - n));
    let most = REACH_CELLS.min(cells.len() - 1 - i);
    let to = (0..=most).rev().find(|&n| is_joined(i + n));
    let (from, to) = (i - from.unwrap_or(0), i + to.unwrap_or(0));
    if from == to {
        return 0.0;
    }
    let climb_percent = cells[to].grade_percent - cells[from].grade_percent;
    climb_percent / ((to - from) as f64 * GRID_M)
}
