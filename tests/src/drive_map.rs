//! The map of the road of [`crate::drive`]: a way that forks, so that the road ahead has branches.

use host_sim::map::{GRID_M, MapRow, WayDirection, WayName, WayRows, packed_map};
use std::f64::consts::TAU;

/// Where the road of the drive begins, degrees.
const START_DEG: (f64, f64) = (55.7, 13.1);
/// Metres of 10⁻⁷ degrees of latitude, as the drive has them, and of longitude there.
const METRES_PER_E7: (f64, f64) = (0.011_1, 0.006_27);
/// Where the road forks, m; and the length of each way behind, m.
const FORK_M: f64 = 1_500.0;
const BEHIND_M: f64 = 3_000.0;
/// Hills as those of the drive: their length, m, and their steepest grade, %.
const HILL_M: f64 = 700.0;
const STEEPEST_PERCENT: f64 = 1.5;

/// Returns the packed map: a way to the fork, one straight on, and one that leaves it to the right.
///
/// # Panics
/// Panics if the map cannot be packed.
#[must_use]
pub fn drive_map() -> Vec<u8> {
    let ways = [
        way("to the fork", (0.0, FORK_M), 0.0),
        way("straight on", (FORK_M, FORK_M + BEHIND_M), 0.0),
        way("to the right", (FORK_M, FORK_M + BEHIND_M), 0.7),
    ];
    packed_map(&ways).expect("three ways that join")
}

/// Returns a way between two distances. Behind the fork it leads to the east by this part.
fn way(name: &str, (from_m, to_m): (f64, f64), east: f64) -> WayRows {
    let cells = ((to_m - from_m) / GRID_M) as u32;
    let rows = (0..=cells).map(|cell| {
        let distance_m = GRID_M * f64::from(cell);
        let road_m = from_m + distance_m;
        let east_m = east * distance_m;
        let north_m = from_m + distance_m * (1.0 - east * east).sqrt();
        let phase = TAU * road_m / HILL_M;
        let climb_m = STEEPEST_PERCENT / 100.0 * HILL_M / TAU * (1.0 - phase.cos());
        MapRow {
            distance_m,
            latitude_deg: START_DEG.0 + 1e-7 * north_m / METRES_PER_E7.0,
            longitude_deg: START_DEG.1 + 1e-7 * east_m / METRES_PER_E7.1,
            altitude_m: Some(120.0 + climb_m),
            grade_percent: STEEPEST_PERCENT * phase.sin(),
            grade_sigma_percent: 0.04,
            runs: 3,
        }
    });
    WayRows {
        name: Some(WayName {
            way: name.to_owned(),
            direction: WayDirection::Forward,
        }),
        rows: rows.collect(),
    }
}
