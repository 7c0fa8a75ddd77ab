//! Altitudes of runs that count from different datums.
//!
//! Receivers count from the ellipsoid or from the sea, tens of metres apart. Where runs of another
//! datum begin or end, the mean altitude steps. No road does: from one cell to the next it climbs by
//! its grade. So steps are taken out, and the whole stays where its mean was.

use super::map_row::MapRow;
use crate::map::geometry::grid::GRID_M;

/// Difference of altitudes of successive cells beyond their climb that is a step, m. The grade is
/// known to a centimetre over a cell.
const STEP_M: f64 = 1.0;

/// Takes steps out of the altitudes of a way. Each row has the weight of its altitude.
pub fn join(rows: &mut [(MapRow, f64)]) {
    let mut shifts_m = vec![0.0; rows.len()];
    for i in 1..rows.len() {
        shifts_m[i] = shifts_m[i - 1] - step_m(&rows[i - 1].0, &rows[i].0);
    }
    if shifts_m.iter().all(|shift_m| *shift_m == 0.0) {
        return;
    }
    let weight: f64 = rows.iter().map(|(_, weight)| weight).sum();
    let weighted = rows.iter().zip(&shifts_m);
    let sum: f64 = weighted
        .map(|((_, weight), shift_m)| weight * shift_m)
        .sum();
    for ((row, _), shift_m) in rows.iter_mut().zip(shifts_m) {
        row.altitude_m = row.altitude_m.map(|m| m + shift_m - sum / weight);
    }
}

/// Returns the step of the altitude between two rows, m; 0 if there is none, or a gap.
fn step_m(from: &MapRow, to: &MapRow) -> f64 {
    let (Some(from_m), Some(to_m)) = (from.altitude_m, to.altitude_m) else {
        return 0.0;
    };
    let length_m = to.distance_m - from.distance_m;
    if length_m > 1.5 * GRID_M {
        return 0.0;
    }
    let climb_m = 0.5 * (from.grade_percent + to.grade_percent) / 100.0 * length_m;
    let step_m = to_m - from_m - climb_m;
    if step_m.abs() > STEP_M { step_m } else { 0.0 }
}
