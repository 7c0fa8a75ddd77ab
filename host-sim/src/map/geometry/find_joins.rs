//! Finds the joins of a network.

use super::joins::{Join, Joins};
use super::plane::earth_centred;
use super::road_index::Surroundings;
use super::way_index::WayIndex;
use std::collections::BTreeSet;

/// An end of a way within this distance of another way joins it, m, for networks whose ways share
/// no points.
const END_REACH_M: f64 = 5.0;
/// A way that ends this far along from where it passes itself is a loop, m.
const SHORTEST_LOOP_M: f64 = 40.0;
/// Points whose coordinates round to the same value are one, 1/deg (a centimetre).
const SAME_POINT: f64 = 1e7;

/// Finds the joins: ways join where they share a point, and where one ends at another. A way and
/// its own opposite direction do not join, because trucks do not make U-turns on the road.
pub(crate) fn find_joins(ways: &WayIndex) -> Joins {
    let mut joins = shared_points(ways);
    joins.retain(|join| !is_u_turn(ways, join));
    // An end that shares a point with another way is joined as the network states it.
    let joined: BTreeSet<(usize, u64)> = joins
        .iter()
        .flat_map(|join| [(join.way, join.at_m), (join.to_way, join.to_m)])
        .map(|(way, at_m)| (way, at_m.to_bits()))
        .collect();
    joins.extend(ends(ways, |way, at_m| {
        joined.contains(&(way, at_m.to_bits()))
    }));
    joins.retain(|join| !is_u_turn(ways, join));
    joins.sort_by(|a, b| {
        (a.way, a.to_way)
            .cmp(&(b.way, b.to_way))
            .then(a.at_m.total_cmp(&b.at_m))
            .then(a.to_m.total_cmp(&b.to_m))
    });
    joins.dedup_by(|a, b| {
        (a.way, a.to_way) == (b.way, b.to_way)
            && (a.at_m - b.at_m).abs() < END_REACH_M
            && (a.to_m - b.to_m).abs() < END_REACH_M
    });
    Joins::new(ways.ways().len(), joins)
}

fn shared_points(ways: &WayIndex) -> Vec<Join> {
    let mut points: Vec<([i64; 2], usize, f64)> = Vec::new();
    for (way, of_way) in ways.ways().iter().enumerate() {
        points.extend(of_way.line.points().iter().map(|point| {
            let place = [point.latitude_deg, point.longitude_deg];
            let place = place.map(|angle| (angle * SAME_POINT).round() as i64);
            (place, way, point.distance_m)
        }));
    }
    points.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    let mut joins = Vec::new();
    for shared in points.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, way, at_m)) in shared.iter().enumerate() {
            for (k, &(_, to_way, to_m)) in shared.iter().enumerate() {
                if i != k {
                    joins.push(join(ways, (way, at_m), (to_way, to_m)));
                }
            }
        }
    }
    joins
}

/// Returns the joins of ends with nearby ways, except for ends that are already joined.
fn ends(ways: &WayIndex, is_joined: impl Fn(usize, f64) -> bool) -> Vec<Join> {
    let mut joins = Vec::new();
    for (way, of_way) in ways.ways().iter().enumerate() {
        let line = &of_way.line;
        for (at_m, is_end) in [(line.start_m(), false), (line.end_m(), true)] {
            if is_joined(way, at_m) {
                continue;
            }
            let (latitude_deg, longitude_deg) = line.position_at(at_m);
            let place_m = earth_centred(latitude_deg, longitude_deg);
            let mut nearby = Vec::new();
            ways.nearby(
                &Joins::default(),
                &mut Surroundings::default(),
                place_m,
                |_| None,
                &mut nearby,
            );
            for near in nearby {
                let is_itself =
                    near.way == way && (near.foot.distance_m - at_m).abs() < SHORTEST_LOOP_M;
                if is_itself || near.foot.lateral_m2 > END_REACH_M * END_REACH_M {
                    continue;
                }
                // A way has no joins beyond its ends. It is not left at its start, or entered at
                // its end.
                let other = &ways.ways()[near.way].line;
                let other_m = near.foot.distance_m;
                let (start_m, end_m) = (other.start_m(), other.end_m());
                let is_there = if is_end {
                    other_m >= start_m - END_REACH_M && other_m < end_m
                } else {
                    other_m > start_m && other_m <= end_m + END_REACH_M
                };
                if !is_there {
                    continue;
                }
                let other_m = other_m.clamp(start_m, end_m);
                let (here, there) = ((way, at_m), (near.way, other_m));
                let (from, to) = if is_end { (here, there) } else { (there, here) };
                joins.push(join(ways, from, to));
            }
        }
    }
    joins
}

fn join(ways: &WayIndex, from: (usize, f64), to: (usize, f64)) -> Join {
    let (left, entered) = (&ways.ways()[from.0].line, &ways.ways()[to.0].line);
    Join {
        way: from.0,
        at_m: from.1,
        to_way: to.0,
        to_m: to.1,
        turns: from.1 < left.end_m() - END_REACH_M || to.1 > entered.start_m() + END_REACH_M,
    }
}

fn is_u_turn(ways: &WayIndex, join: &Join) -> bool {
    let [from, to] = [join.way, join.to_way].map(|way| ways.ways()[way].name.as_ref());
    from.zip(to)
        .is_some_and(|(from, to)| from.way == to.way && from.direction != to.direction)
}
