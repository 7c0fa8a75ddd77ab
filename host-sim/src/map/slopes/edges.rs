//! Slopes of the edges of a network, as routers define them.
//!
//! An edge is the part of a way from one junction to the next, in one direction. GraphHopper's
//! `average_slope` is the rise over the length, `max_slope` the steepest part
//! (<https://github.com/graphhopper/graphhopper/blob/master/docs/core/custom-models.md>); Valhalla
//! has the steepest part uphill and the steepest downhill
//! (<https://valhalla.github.io/valhalla/api/locate/api-reference/>).

use super::profile::{LEAST_COVERED, Stretch, WayProfile};
use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::WayDirection;
use std::collections::BTreeMap;
use std::ops::Range;

/// Length of the parts among which the steepest is searched, m: a vehicle of any length feels it,
/// and a single cell is no part.
const PART_M: f64 = 25.0;
/// Points whose coordinates round to the same value are one, 1/deg (a centimetre).
const SAME_POINT: f64 = 1e7;

/// An edge in one direction of travel.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge<'n> {
    /// Name of the way.
    pub way: Option<&'n str>,
    /// Direction of travel.
    pub direction: WayDirection,
    /// Distances along the order of the points, m.
    pub range_m: Range<f64>,
    /// Its first and last position in the direction of travel: latitude and longitude, deg.
    pub ends_deg: [(f64, f64); 2],
    /// What carries it.
    pub structure: Option<Structure>,
    /// Its slopes; `None` if the map has no cell of it.
    pub slopes: Option<Slopes>,
}

/// Slopes in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes {
    /// Mean over the cells that the map has.
    pub mean: Stretch,
    /// Steepest part uphill, %; 0 if nothing rises.
    pub largest_up_percent: f64,
    /// Steepest part downhill, %, negative; 0 if nothing falls.
    pub largest_down_percent: f64,
    /// True if only runs in the other direction tell it.
    pub from_other_direction: bool,
}

/// Returns the edges of all ways, in the order of the ways.
#[must_use]
pub fn edges<'n>(profiles: &[WayProfile<'n>]) -> Vec<Edge<'n>> {
    let passes = passes(profiles);
    profiles
        .iter()
        .flat_map(|profile| {
            let ranges = ranges(profile, &passes);
            profile.directions.iter().flat_map(move |&direction| {
                ranges
                    .clone()
                    .into_iter()
                    .map(move |range| edge(profile, direction, range))
            })
        })
        .collect()
}

/// Returns how often ways pass each place.
fn passes(profiles: &[WayProfile<'_>]) -> BTreeMap<[i64; 2], u32> {
    let mut passes = BTreeMap::new();
    for point in profiles.iter().flat_map(|profile| &profile.points) {
        *passes
            .entry(place(point.latitude_deg, point.longitude_deg))
            .or_default() += 1;
    }
    passes
}

fn place(latitude_deg: f64, longitude_deg: f64) -> [i64; 2] {
    [latitude_deg, longitude_deg].map(|angle| (angle * SAME_POINT).round() as i64)
}

/// Returns the parts of a way between junctions.
fn ranges(profile: &WayProfile<'_>, passes: &BTreeMap<[i64; 2], u32>) -> Vec<Range<f64>> {
    let last = profile.points.len() - 1;
    let is_junction = |i: usize| {
        let point = profile.points[i];
        i == 0 || i == last || passes[&place(point.latitude_deg, point.longitude_deg)] > 1
    };
    let at_m: Vec<f64> = (0..=last)
        .filter(|&i| is_junction(i))
        .map(|i| profile.points[i].distance_m)
        .collect();
    at_m.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

fn edge<'n>(profile: &WayProfile<'n>, direction: WayDirection, range_m: Range<f64>) -> Edge<'n> {
    let positions = profile.positions(&range_m);
    let mut ends_deg = [positions[0], positions[positions.len() - 1]];
    if direction == WayDirection::Backward {
        ends_deg.reverse();
    }
    Edge {
        way: profile.way,
        direction,
        ends_deg,
        structure: profile.structure,
        slopes: slopes(profile, direction, &range_m),
        range_m,
    }
}

/// Returns the slopes from the runs in the edge's direction, else from those in the other.
fn slopes(
    profile: &WayProfile<'_>,
    direction: WayDirection,
    range_m: &Range<f64>,
) -> Option<Slopes> {
    use WayDirection::{Backward, Forward};
    let other = if direction == Forward {
        Backward
    } else {
        Forward
    };
    let driven = [direction, other]
        .into_iter()
        .find(|&driven| profile.part(driven, range_m).is_some())?;
    let sign = if direction == Forward { 1.0 } else { -1.0 };
    let mean = profile.part(driven, range_m)?;
    let length_m = range_m.end - range_m.start;
    let count = (length_m / PART_M).round().max(1.0);
    let parts = (0..count as usize).map(|i| {
        let at = |i: f64| range_m.start + length_m * i / count;
        at(i as f64)..at(i as f64 + 1.0)
    });
    let parts: Vec<f64> = parts
        .filter_map(|part| profile.part(driven, &part))
        .filter(|part| part.covered >= LEAST_COVERED)
        .map(|part| sign * part.grade_percent)
        .collect();
    Some(Slopes {
        mean: Stretch {
            grade_percent: sign * mean.grade_percent,
            ..mean
        },
        largest_up_percent: parts.iter().copied().fold(0.0, f64::max),
        largest_down_percent: parts.iter().copied().fold(0.0, f64::min),
        from_other_direction: driven != direction,
    })
}
