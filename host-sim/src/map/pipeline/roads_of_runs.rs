//! The roads of runs, where no file gives them: the tracks of the runs themselves.
//!
//! The longest run gives the first road. Where a run leaves the roads so far, or drives them in the
//! other direction, its track is the next road. A track that comes back to itself ends there: a
//! road is driven once.

use crate::files::run::RunCell;
use crate::map::geometry::network::Network;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use crate::map::geometry::way_name::{WayDirection, WayName};
use crate::map::matching::track::{road_of_run, track_of_run};
use crate::map::matching::viterbi::{MatchedPlace, match_track};
use std::collections::BTreeMap;
use std::ops::Range;

/// Shortest new road, m.
const SHORTEST_M: f64 = 300.0;
/// Most roads: later ones are left out.
const MOST_ROADS: usize = 100;
/// A track meets itself where it is this near, m, ...
const NEAR_M: f64 = 20.0;
/// ... after this distance, m, ...
const LAP_M: f64 = 400.0;
/// ... in this direction: cosine of the angle between both.
const SAME_COURSE: f64 = 0.7;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_195.0;
/// Points over which a course is taken.
const COURSE_POINTS: usize = 4;

/// Returns the network of all runs; a single road without a name if one is enough. `None` if no run
/// has positions.
#[must_use]
pub fn roads_of_runs(runs: &[Vec<RunCell>]) -> Option<Network> {
    let mut longest: Vec<&Vec<RunCell>> = runs.iter().collect();
    longest.sort_by_key(|run| std::cmp::Reverse(run.len()));
    let mut roads: Vec<Vec<RoadPoint>> = Vec::new();
    for run in longest {
        let mut tried: Vec<Range<usize>> = Vec::new();
        while roads.len() < MOST_ROADS {
            let whole = || std::iter::once(0..run.len()).collect();
            let ranges = network(&roads).map_or_else(whole, |network| unplaced(&network, run));
            let length_m =
                |range: &Range<usize>| run[range.end - 1].distance_m - run[range.start].distance_m;
            let next = ranges
                .into_iter()
                .filter(|range| !range.is_empty() && !tried.contains(range))
                .filter(|range| length_m(range) >= SHORTEST_M)
                .max_by(|a, b| length_m(a).total_cmp(&length_m(b)));
            let Some(range) = next else { break };
            roads.extend(road(&run[range.clone()]));
            tried.push(range);
        }
    }
    network(&roads)
}

fn network(roads: &[Vec<RoadPoint>]) -> Option<Network> {
    let line = |road: &Vec<RoadPoint>| RoadLine::new(road.clone()).ok();
    match roads {
        [] => None,
        [only] => line(only).map(Network::from),
        _ => {
            let named = roads.iter().enumerate().filter_map(|(number, road)| {
                let name = WayName {
                    // Of equal width, so that names sort as numbers do.
                    way: format!("road {:03}", number + 1),
                    direction: WayDirection::Forward,
                };
                Some((name, line(road)?))
            });
            Some(Network::new(named.collect()))
        }
    }
}

/// Returns the parts of a run that are on no road.
fn unplaced(network: &Network, run: &[RunCell]) -> Vec<Range<usize>> {
    let places = match_track(network, &track_of_run(run));
    let is_off =
        |place: &MatchedPlace| matches!(place, MatchedPlace::OffRoad | MatchedPlace::Opposite);
    let mut ranges = Vec::new();
    let mut start = None;
    for (i, place) in places.iter().enumerate() {
        if is_off(place) {
            start.get_or_insert(i);
        } else if let Some(start) = start.take() {
            ranges.push(start..i);
        }
    }
    ranges.extend(start.map(|start| start..places.len()));
    ranges
}

/// Returns the road of a part of a run up to where it comes back to itself.
fn road(cells: &[RunCell]) -> Option<Vec<RoadPoint>> {
    let mut points = road_of_run(cells)?;
    points.truncate(first_lap(&points));
    let length_m = points.last()?.distance_m - points.first()?.distance_m;
    let is_road = length_m >= SHORTEST_M && RoadLine::new(points.clone()).is_ok();
    is_road.then_some(points)
}

/// Returns the number of points before the track comes back to itself.
fn first_lap(points: &[RoadPoint]) -> usize {
    let square = |point: &RoadPoint| {
        let along_m = point.longitude_deg * point.latitude_deg.to_radians().cos() * DEGREE_M;
        let number = |m: f64| (m / NEAR_M).floor() as i64;
        (number(point.latitude_deg * DEGREE_M), number(along_m))
    };
    let place = |point: &RoadPoint| (point.latitude_deg, point.longitude_deg, 0.0);
    let mut squares: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, point) in points.iter().enumerate() {
        let (north, east) = square(point);
        let around = (-1..=1).flat_map(|n| (-1..=1).map(move |e| (north + n, east + e)));
        let meets = around
            .filter_map(|at| squares.get(&at))
            .flatten()
            .any(|&j| {
                let earlier = &points[j];
                point.distance_m - earlier.distance_m > LAP_M
                    && chord_m(place(earlier), place(point)) < NEAR_M
                    && course_cosine(points, i, j) > SAME_COURSE
            });
        if meets {
            return i;
        }
        squares.entry((north, east)).or_default().push(i);
    }
    points.len()
}

/// Returns the cosine of the angle between the courses at two points.
fn course_cosine(points: &[RoadPoint], i: usize, j: usize) -> f64 {
    let course = |at: usize| {
        let (from, to) = (&points[at.saturating_sub(COURSE_POINTS)], &points[at]);
        let shrink = to.latitude_deg.to_radians().cos();
        let north = to.latitude_deg - from.latitude_deg;
        let east = (to.longitude_deg - from.longitude_deg) * shrink;
        let length = north.hypot(east).max(1e-12);
        (north / length, east / length)
    };
    let (a, b) = (course(i), course(j));
    a.0 * b.0 + a.1 * b.1
}
