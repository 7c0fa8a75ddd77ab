//! A run's cells on the grid of each way: all that a map takes of it.

use super::alignment::{Leg, Stretch, stretches};
use super::track::track_of_run;
use super::viterbi::{Place, match_track};
use crate::files::run::RunCell;
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::network::Network;

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

/// What a run knows of one cell of a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCell {
    /// Which way of the network; 0 of a single road.
    pub way: usize,
    /// Distance along the way over 2.5 m.
    pub number: i64,
    pub grade_percent: f64,
    /// Square of the sigma, %².
    pub grade_variance: f64,
    /// Altitude, m, and its variance, m².
    pub altitude: Option<(f64, f64)>,
}

/// A run on a network.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedRun {
    pub coverage: Coverage,
    /// In the order in which they were driven; a road that passes a place twice has it twice.
    pub cells: Vec<PlacedCell>,
}

/// Places a run on a network.
pub fn place(network: &Network, cells: &[RunCell]) -> PlacedRun {
    let track = track_of_run(cells);
    let places = match_track(network, &track);
    let count = |wanted: Place| places.iter().filter(|&&place| place == wanted).count();
    let mut coverage = Coverage {
        cells: cells.len(),
        off_road: count(Place::OffRoad),
        opposite: count(Place::Opposite),
        ..Coverage::default()
    };
    let mut placed = Vec::with_capacity(cells.len());
    for stretch in stretches(network, &track, &places) {
        coverage.matched += stretch.points.len();
        place_stretch(&mut placed, network, cells, &stretch);
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
    network: &Network,
    cells: &[RunCell],
    stretch: &Stretch,
) {
    let cells = &cells[stretch.points.clone()];
    let mut legs = stretch.legs.iter();
    let Some(mut leg) = legs.next() else {
        return;
    };
    let numbers = |leg: &Leg| network.ways()[leg.way].line.cell_numbers();
    // Number of the first cell of this leg that this run has not yet filled.
    let mut next = *numbers(leg).start();
    for (pair, at_m) in cells.windows(2).zip(stretch.distance_m.windows(2)) {
        let (from_m, to_m) = (at_m[0], at_m[1]);
        if to_m <= from_m || pair[1].distance_m - pair[0].distance_m > JOIN_LIMIT_M {
            continue;
        }
        loop {
            let following = legs.as_slice().first();
            let until_m = following.map_or(f64::INFINITY, |leg| leg.begins_m);
            let begin = (((from_m - leg.offset_m) / GRID_M).ceil() as i64).max(next);
            let end = ((to_m.min(until_m) - leg.offset_m) / GRID_M).floor() as i64;
            for number in begin..=end.min(*numbers(leg).end()) {
                let here_m = number as f64 * GRID_M + leg.offset_m;
                let part = (here_m - from_m) / (to_m - from_m);
                placed.push(between((leg.way, number), &pair[0], &pair[1], part));
            }
            next = next.max(end + 1);
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

/// What a run knows between two of its cells.
fn between((way, number): (usize, i64), a: &RunCell, b: &RunCell, part: f64) -> PlacedCell {
    let mix = |a: f64, b: f64| a + part * (b - a);
    PlacedCell {
        way,
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
