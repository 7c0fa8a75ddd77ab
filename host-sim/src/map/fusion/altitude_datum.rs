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
pub(super) fn join(rows: &mut [(MapRow, f64)]) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A road that climbs by 2 %, with altitudes that are higher by so much.
    fn rows(higher_m: impl Fn(usize) -> f64) -> Vec<(MapRow, f64)> {
        let row = |i: usize| MapRow {
            distance_m: i as f64 * GRID_M,
            latitude_deg: 47.0,
            longitude_deg: 8.0,
            altitude_m: Some(400.0 + 0.02 * i as f64 * GRID_M + higher_m(i)),
            grade_percent: 2.0,
            grade_sigma_percent: 0.1,
            runs: 1,
        };
        (0..1_000).map(|i| (row(i), 1.0)).collect()
    }

    #[test]
    fn a_run_of_another_datum_leaves_no_step() {
        // Two runs; the one over the middle counts from 34 m higher, and is half of the weight.
        let mut joined = rows(|i| if (300..600).contains(&i) { 17.0 } else { 0.0 });
        let mean_m = |rows: &[(MapRow, f64)]| -> f64 {
            let sum: f64 = rows.iter().filter_map(|(row, _)| row.altitude_m).sum();
            sum / rows.len() as f64
        };
        let before_m = mean_m(&joined);
        join(&mut joined);
        assert!((mean_m(&joined) - before_m).abs() < 1e-9);
        for pair in joined.windows(2) {
            let climb_m = pair[1].0.altitude_m.unwrap() - pair[0].0.altitude_m.unwrap();
            assert!((climb_m - 0.05).abs() < 1e-9, "{climb_m}");
        }
    }

    #[test]
    fn what_has_no_step_stays_to_the_last_bit() {
        let drift = |i: usize| 0.9 * (i as f64 / 100.0).sin();
        let mut joined = rows(drift);
        join(&mut joined);
        assert_eq!(joined, rows(drift));
    }
}
