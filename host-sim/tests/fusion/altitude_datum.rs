//! Altitudes of runs with different datums, joined in a map.

use host_sim::map::MapRow;
use host_sim::map::fusion::altitude_datum::join;
use host_sim::map::geometry::grid::GRID_M;

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
