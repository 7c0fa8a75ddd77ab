//! Cells in which signals disagree: they count little beside consistent ones.

use host_sim::files::run::RunRow;
use host_sim::map::{MapRow, Network, RoadLine};
use test_kit::roads::{fuse, hill_percent, hills, points, run};

/// Grade that the suspect run reads too high, %.
const OFF_PERCENT: f64 = 0.5;

/// A run whose second half is off and says so.
fn half_suspect() -> Vec<RunRow> {
    let mut rows = run(&hills());
    let half = rows.len() / 2;
    for row in &mut rows[half..] {
        row.grade_percent += OFF_PERCENT;
        row.consistent = 0;
    }
    rows
}

fn map_of(runs: &[&[RunRow]]) -> Vec<MapRow> {
    let road: Network = RoadLine::new(points(&hills())).expect("a road").into();
    fuse(&road, runs).map.fused().rows()
}

/// Rows of the second half, its ends left out.
fn later(rows: &[MapRow]) -> &[MapRow] {
    &rows[rows.len() / 2 + 10..rows.len() - 10]
}

#[test]
fn a_road_known_by_suspect_cells_alone_has_a_wide_sigma() {
    let map = map_of(&[&half_suspect()]);
    for row in &map[10..map.len() / 2 - 10] {
        // Besides, a place that is wrong by metres costs up to 0.016 % on these hills.
        let sigma_percent = row.grade_sigma_percent;
        assert!((0.1 - 1e-9..0.102).contains(&sigma_percent), "{row:?}");
    }
    for row in later(&map) {
        let sigma_percent = row.grade_sigma_percent;
        assert!((0.4 - 1e-9..0.401).contains(&sigma_percent), "{row:?}");
        let error = row.grade_percent - hill_percent(row.distance_m);
        assert!((error - OFF_PERCENT).abs() < 1e-3, "{row:?}");
    }
}

#[test]
fn beside_a_consistent_run_they_have_a_sixteenth_of_its_weight() {
    let map = map_of(&[&half_suspect(), &run(&hills())]);
    for row in later(&map) {
        let error = row.grade_percent - hill_percent(row.distance_m);
        assert!((error - OFF_PERCENT / 17.0).abs() < 1e-3, "{error}");
    }
}
