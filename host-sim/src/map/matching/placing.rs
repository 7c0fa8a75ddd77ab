//! The cells of a run on the grid of each way.

use super::alignment::{Leg, MatchedSegment, matched_segments};
use super::knots::JOIN_LIMIT_M;
use super::match_run::{MatchedRun, match_every_cell, match_run};
use super::viterbi::MatchedPlace;
use crate::files::run::RunCell;
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::network::Network;

/// Factor on the sigmas of a cell in which signals disagree. With it such a cell has a sixteenth of
/// the weight of a consistent one with the same sigma: it moves a mean little, and a road that is
/// known only by such cells still has a map, with a wide sigma. The factor is chosen.
const SUSPECT_SIGMA_FACTOR: f64 = 4.0;

/// Coverage of the road by a run, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Number of cells of the run.
    pub cells: usize,
    /// On the road, cells bridged by odometer included.
    pub matched: usize,
    /// Off the road.
    pub off_road: usize,
    /// On the road, but against its direction.
    pub opposite: usize,
    /// Without a position and not bridged.
    pub no_position: usize,
}

/// The estimate of a run in one cell of a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCell {
    /// Index of the way; 0 for a single road.
    pub way: usize,
    /// Distance along the way over 2.5 m.
    pub number: i64,
    /// Grade in the direction of the way, %.
    pub grade_percent: f64,
    /// Variance of the grade, %².
    pub grade_variance: f64,
    /// Altitude, m, and its variance, m².
    pub altitude: Option<(f64, f64)>,
    /// Whether signals agree in the cells of the run around it.
    pub is_consistent: bool,
}

/// A run placed on a network.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedRun {
    /// Coverage of the network.
    pub coverage: Coverage,
    /// In the order of driving; a road that passes a place twice has it twice.
    pub cells: Vec<PlacedCell>,
}

/// Places a run on a network.
pub fn place(network: &Network, cells: &[RunCell]) -> PlacedRun {
    place_matched(network, cells, &match_run(network, cells))
}

/// Places a run on a network as [`place`] does, but matches each cell: slower, to compare with.
pub fn place_every_cell(network: &Network, cells: &[RunCell]) -> PlacedRun {
    place_matched(network, cells, &match_every_cell(network, cells))
}

fn place_matched(network: &Network, cells: &[RunCell], run: &MatchedRun) -> PlacedRun {
    let count = |wanted: MatchedPlace| {
        let knots = run.knots.iter().zip(&run.places);
        let wanted = knots.filter(|(_, place)| **place == wanted);
        wanted.map(|(knot, _)| knot.cells.len()).sum()
    };
    let mut coverage = Coverage {
        cells: cells.len(),
        off_road: count(MatchedPlace::OffRoad),
        opposite: count(MatchedPlace::Opposite),
        ..Coverage::default()
    };
    let mut placed = Vec::with_capacity(cells.len());
    for segment in matched_segments(network, cells, run) {
        coverage.matched += segment.cells.len();
        place_segment(&mut placed, network, cells, &segment);
    }
    coverage.no_position =
        coverage.cells - coverage.matched - coverage.off_road - coverage.opposite;
    PlacedRun {
        coverage,
        cells: placed,
    }
}

/// Returns the distance of each cell along a single road, m, smooth along the drive; `None` where
/// the run is not on the road.
#[must_use]
pub fn road_distances(road: &Network, cells: &[RunCell]) -> Vec<Option<f64>> {
    let mut distances = vec![None; cells.len()];
    for segment in matched_segments(road, cells, &match_run(road, cells)) {
        let offset_m = segment.legs.first().map_or(0.0, |leg| leg.offset_m);
        for (index, along_m) in segment.cells.zip(segment.distance_m) {
            distances[index] = Some(along_m - offset_m);
        }
    }
    distances
}

/// Interpolates a segment onto the grid. Errors of neighbouring cells are almost equal, so
/// variances are interpolated and not reduced.
fn place_segment(
    placed: &mut Vec<PlacedCell>,
    network: &Network,
    cells: &[RunCell],
    segment: &MatchedSegment,
) {
    let cells = &cells[segment.cells.clone()];
    let mut legs = segment.legs.iter();
    let Some(mut leg) = legs.next() else {
        return;
    };
    let numbers = |leg: &Leg| network.ways()[leg.way].line.cell_numbers();
    // Index of the first cell of this leg that the run has not yet filled.
    let mut next = *numbers(leg).start();
    for (pair, at_m) in cells.windows(2).zip(segment.distance_m.windows(2)) {
        let (from_m, to_m) = (at_m[0], at_m[1]);
        if to_m <= from_m || pair[1].distance_m - pair[0].distance_m > JOIN_LIMIT_M {
            continue;
        }
        loop {
            let following = legs.as_slice().first();
            let until_m = following.map_or(f64::INFINITY, |leg| leg.begins_m);
            let at_cell = |number: i64| number as f64 * GRID_M + leg.offset_m;
            // The next cell is almost always between these two.
            if at_cell(next) < from_m {
                next = next.max(((from_m - leg.offset_m) / GRID_M).ceil() as i64);
            }
            let end_m = to_m.min(until_m);
            let last = *numbers(leg).end();
            while next <= last && at_cell(next) <= end_m {
                let part = (at_cell(next) - from_m) / (to_m - from_m);
                placed.push(between((leg.way, next), &pair[0], &pair[1], part));
                next += 1;
            }
            let Some(following) = following.filter(|_| to_m > until_m) else {
                break;
            };
            legs.next();
            leg = following;
            let entered = ((leg.begins_m - leg.offset_m) / GRID_M).ceil() as i64;
            next = entered.max(*numbers(leg).start());
        }
    }
}

/// Returns the estimate between two cells of a run.
fn between((way, number): (usize, i64), a: &RunCell, b: &RunCell, part: f64) -> PlacedCell {
    let mix = |a: f64, b: f64| a + part * (b - a);
    PlacedCell {
        way,
        number,
        grade_percent: mix(a.grade_percent, b.grade_percent),
        grade_variance: mix(
            variance_of(a, a.grade_sigma_percent),
            variance_of(b, b.grade_sigma_percent),
        ),
        altitude: a
            .altitude
            .zip(b.altitude)
            .map(|((a_m, a_sigma), (b_m, b_sigma))| {
                let variance = mix(variance_of(a, a_sigma), variance_of(b, b_sigma));
                (mix(a_m, b_m), variance)
            }),
        is_consistent: a.is_consistent && b.is_consistent,
    }
}

/// Returns the variance with which a cell of this sigma counts.
fn variance_of(cell: &RunCell, sigma: f64) -> f64 {
    let factor = if cell.is_consistent {
        1.0
    } else {
        SUSPECT_SIGMA_FACTOR
    };
    (factor * sigma).powi(2)
}
