//! A run's cells on the grid of a road: all that a map takes of it.

use super::GRID_M;
use super::alignment::{Stretch, stretches};
use super::cell_sums::CellSums;
use super::matching::{Place, match_track};
use super::road_line::RoadLine;
use super::track::track_of_run;
use crate::run_cell::RunCell;

/// Cells of a run farther apart than this are not joined, m: two rows of a RUN.csv are missing.
const JOIN_LIMIT_M: f64 = 8.0;

/// How much of a run lies on the road, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    pub cells: usize,
    /// On the road, those bridged by odometer included.
    pub matched: usize,
    pub off_road: usize,
    /// At the road, driven against its direction.
    pub opposite: usize,
    /// Without a position, and not bridged.
    pub no_position: usize,
}

/// What a run knows of one cell of the road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCell {
    /// Distance along the road over 2.5 m.
    pub number: i64,
    pub grade_percent: f64,
    /// Square of the sigma, %².
    pub grade_variance: f64,
    /// Altitude, m, and its variance, m².
    pub altitude: Option<(f64, f64)>,
}

impl PlacedCell {
    pub(super) fn sums(&self) -> CellSums {
        CellSums::of((self.grade_percent, self.grade_variance), self.altitude)
    }
}

/// A run on a road.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedRun {
    pub coverage: Coverage,
    /// In the order in which they were driven; a road that passes a place twice has it twice.
    pub cells: Vec<PlacedCell>,
}

/// Places a run on a road.
pub fn place(road: &RoadLine, cells: &[RunCell]) -> PlacedRun {
    let track = track_of_run(cells);
    let places = match_track(road, &track);
    let count = |wanted: Place| places.iter().filter(|&&place| place == wanted).count();
    let mut coverage = Coverage {
        cells: cells.len(),
        off_road: count(Place::OffRoad),
        opposite: count(Place::Opposite),
        ..Coverage::default()
    };
    let mut placed = Vec::with_capacity(cells.len());
    for stretch in stretches(&track, &places) {
        coverage.matched += stretch.points.len();
        place_stretch(&mut placed, road, cells, &stretch);
    }
    coverage.no_position =
        coverage.cells - coverage.matched - coverage.off_road - coverage.opposite;
    PlacedRun {
        coverage,
        cells: placed,
    }
}

/// Interpolates a run onto the grid between neighbouring cells. Errors of neighbours are nearly
/// the same, so variances are interpolated, not reduced.
fn place_stretch(
    placed: &mut Vec<PlacedCell>,
    road: &RoadLine,
    cells: &[RunCell],
    stretch: &Stretch,
) {
    let cells = &cells[stretch.points.clone()];
    let numbers = road.cell_numbers();
    // Number of the first cell that this run has not yet filled.
    let mut next = *numbers.start();
    for (pair, at_m) in cells.windows(2).zip(stretch.distance_m.windows(2)) {
        let (from_m, to_m) = (at_m[0], at_m[1]);
        if to_m <= from_m || pair[1].distance_m - pair[0].distance_m > JOIN_LIMIT_M {
            continue;
        }
        let begin = ((from_m / GRID_M).ceil() as i64).max(next);
        let end = (to_m / GRID_M).floor() as i64;
        for number in begin..=end.min(*numbers.end()) {
            let part = (number as f64 * GRID_M - from_m) / (to_m - from_m);
            placed.push(between(number, &pair[0], &pair[1], part));
        }
        next = next.max(end + 1);
    }
}

/// What a run knows between two of its cells.
fn between(number: i64, a: &RunCell, b: &RunCell, part: f64) -> PlacedCell {
    let mix = |a: f64, b: f64| a + part * (b - a);
    PlacedCell {
        number,
        grade_percent: mix(a.grade_percent, b.grade_percent),
        grade_variance: mix(a.grade_sigma_percent.powi(2), b.grade_sigma_percent.powi(2)),
        altitude: a
            .altitude
            .zip(b.altitude)
            .map(|((a_m, a_sigma), (b_m, b_sigma))| {
                (mix(a_m, b_m), mix(a_sigma.powi(2), b_sigma.powi(2)))
            }),
    }
}
