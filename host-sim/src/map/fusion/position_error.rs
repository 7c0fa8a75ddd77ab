//! What an error of the place along the road costs: the change of the grade times that error.

use super::map_row::MapRow;
use crate::map::geometry::grid::GRID_M;

/// Error of a run's own place along the road, 1 sigma, m: slow errors of receivers are 1 to 2 m.
const OF_A_RUN_M: f64 = 1.5;
/// Error that all runs have in common, 1 sigma, m: ages of torque and speed, and 0.02 s of latency.
const COMMON_M: f64 = 0.4;
/// Cells on either side over which the change of the grade is taken: 10 m.
const REACH_CELLS: usize = 4;

/// Returns the variance of the grade of each row, %², that is owed to the error of its place.
pub(super) fn variances(rows: &[MapRow]) -> impl Iterator<Item = f64> {
    rows.iter().enumerate().map(|(i, row)| {
        let place_m2 = COMMON_M.powi(2) + OF_A_RUN_M.powi(2) / f64::from(row.runs.max(1));
        place_m2 * change_per_m(rows, i).powi(2)
    })
}

/// Returns the change of the grade along the road at a row, % per m. Beside a gap it is that of one
/// side, and 0 between two.
fn change_per_m(rows: &[MapRow], i: usize) -> f64 {
    let is_joined = |j: &usize| {
        let apart_m = (rows[*j].distance_m - rows[i].distance_m).abs();
        (apart_m - REACH_CELLS as f64 * GRID_M).abs() < 0.5 * GRID_M
    };
    let from = i.checked_sub(REACH_CELLS).filter(is_joined).unwrap_or(i);
    let to = Some(i + REACH_CELLS)
        .filter(|to| *to < rows.len())
        .filter(is_joined)
        .unwrap_or(i);
    if from == to {
        return 0.0;
    }
    (rows[to].grade_percent - rows[from].grade_percent) / ((to - from) as f64 * GRID_M)
}
