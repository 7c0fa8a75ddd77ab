//! Where ways of a network join, and how far it is from one to another.

use super::network::Network;
use super::plane::earth_centred;
use super::road_index::Surroundings;
use pathfinding::prelude::dijkstra_reach;
use std::collections::BTreeSet;
use std::ops::Range;

/// An end of a way within this of another way joins it, m: networks of which ways do not share
/// their points.
const END_REACH_M: f64 = 5.0;
/// A position may be this far behind a join before the way is left there, or before the join as
/// the next way is entered, m: noise along the road.
const BACK_M: f64 = 10.0;
/// Points whose coordinates round to the same here are one, 1/deg (a centimetre).
const SAME_POINT: f64 = 1e7;

/// From a point of one way to a point of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Join {
    pub way: usize,
    pub at_m: f64,
    pub to_way: usize,
    pub to_m: f64,
    /// The way goes on, or the other begins before: to take the join is a choice.
    pub turns: bool,
}

/// The joins of a network; without any by default.
#[derive(Debug, Default)]
pub(super) struct Joins {
    /// Those that leave each way, along it.
    leaving: Vec<Vec<Join>>,
    /// Where each way is left or entered, along it.
    places: Vec<Vec<f64>>,
}

/// A join that is taken: its way, and its number among those that leave it.
type Taken = (usize, usize);

/// From a place on one way to one on another, or on the same.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Route {
    /// How far its length, forwards and backwards, is from the driven distance, m.
    pub mismatch_m: f64,
    pub joins: Vec<Join>,
}

impl Joins {
    /// Ways join where they share a point, and where one ends at another. A way and its own
    /// opposite direction do not: a truck does not turn on the road.
    pub(super) fn of(network: &Network) -> Self {
        let mut joins = shared_points(network);
        joins.retain(|join| !is_u_turn(network, join));
        // An end that shares its point with another way is joined as the network has it.
        let joined: BTreeSet<(usize, u64)> = joins
            .iter()
            .flat_map(|join| [(join.way, join.at_m), (join.to_way, join.to_m)])
            .map(|(way, at_m)| (way, at_m.to_bits()))
            .collect();
        joins.extend(ends(network, |way, at_m| {
            joined.contains(&(way, at_m.to_bits()))
        }));
        joins.retain(|join| !is_u_turn(network, join));
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
        let count = network.ways().len();
        let (mut leaving, mut places) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for join in joins {
            places[join.way].push(join.at_m);
            places[join.to_way].push(join.to_m);
            leaving[join.way].push(join);
        }
        for (leaving, places) in leaving.iter_mut().zip(&mut places) {
            leaving.sort_by(|a, b| a.at_m.total_cmp(&b.at_m).then(a.to_way.cmp(&b.to_way)));
            places.sort_by(f64::total_cmp);
        }
        Self { leaving, places }
    }

    /// Whether a way is left or entered within `reach_m` of a place on it.
    pub(super) fn is_near(&self, way: usize, at_m: f64, reach_m: f64) -> bool {
        self.has_place(way, at_m - reach_m..at_m + reach_m)
    }

    /// The route between two places whose length is nearest to what was driven; none of those
    /// longer than `limit_m`.
    pub(super) fn route(
        &self,
        from: (usize, f64),
        to: (usize, f64),
        driven_m: f64,
        limit_m: f64,
    ) -> Option<Route> {
        // Nearly always one of these ends it.
        if self.ahead(from.0, from.1 - BACK_M, limit_m).is_empty()
            || !self.has_place(to.0, to.1 - limit_m..to.1 + BACK_M)
        {
            return None;
        }
        // Nodes are the joins, by way and number, each taken; the start is none of them.
        let first = |node: &Option<Taken>| match *node {
            None => (from.0, from.1 - BACK_M, from.1),
            Some((way, k)) => {
                let join = &self.leaving[way][k];
                (join.to_way, join.to_m, join.to_m)
            }
        };
        let next = |node: &Option<Taken>| {
            let (way, begin_m, here_m) = first(node);
            self.ahead(way, begin_m, limit_m).map(move |k| {
                let length_m = (self.leaving[way][k].at_m - here_m).max(0.0);
                (Some((way, k)), whole_um(length_m))
            })
        };
        let mut seen = Vec::new();
        let mut best: Option<Route> = None;
        for reached in dijkstra_reach(&None, next) {
            let length_m = reached.total_cost as f64 * 1e-6;
            let worst_m = best.as_ref().map_or(f64::INFINITY, |best| best.mismatch_m);
            if length_m > limit_m.min(driven_m + worst_m) {
                break;
            }
            let Some(node @ (way, k)) = reached.node else {
                continue;
            };
            seen.push((node, reached.parent.flatten()));
            let join = self.leaving[way][k];
            if join.to_way != to.0 || to.1 < join.to_m - BACK_M {
                continue;
            }
            let forward_m = length_m + (to.1 - join.to_m).max(0.0);
            if (forward_m - driven_m).abs() >= worst_m {
                continue;
            }
            let joins = self.joins_to(node, &seen);
            let back_m = (from.1 - joins[0].at_m).max(0.0) + (join.to_m - to.1).max(0.0);
            let mismatch_m = (forward_m - driven_m).abs() + back_m;
            if mismatch_m < worst_m {
                best = Some(Route { mismatch_m, joins });
            }
        }
        best
    }

    /// The joins on the way to a node, that of the node included.
    fn joins_to(&self, node: Taken, seen: &[(Taken, Option<Taken>)]) -> Vec<Join> {
        let mut joins = Vec::new();
        let mut at = Some(node);
        while let Some((way, k)) = at {
            joins.push(self.leaving[way][k]);
            at = seen
                .iter()
                .rev()
                .find(|(node, _)| *node == (way, k))
                .and_then(|(_, parent)| *parent);
        }
        joins.reverse();
        joins
    }

    /// Numbers of the joins that leave a way over this distance.
    fn ahead(&self, way: usize, from_m: f64, length_m: f64) -> Range<usize> {
        let Some(leaving) = self.leaving.get(way) else {
            return 0..0;
        };
        let begin = leaving.partition_point(|join| join.at_m < from_m);
        // The start may lie behind the first.
        let end = leaving.partition_point(|join| join.at_m <= from_m + BACK_M + length_m);
        begin..end
    }

    fn has_place(&self, way: usize, within_m: Range<f64>) -> bool {
        let Some(places) = self.places.get(way) else {
            return false;
        };
        let next = places.partition_point(|&at_m| at_m < within_m.start);
        places.get(next).is_some_and(|&at_m| at_m <= within_m.end)
    }
}

fn shared_points(network: &Network) -> Vec<Join> {
    let mut points: Vec<([i64; 2], usize, f64)> = Vec::new();
    for (way, of_way) in network.ways().iter().enumerate() {
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
                    joins.push(join(network, (way, at_m), (to_way, to_m)));
                }
            }
        }
    }
    joins
}

/// Joins of ends, other than those that are joined, with ways that they are near.
fn ends(network: &Network, is_joined: impl Fn(usize, f64) -> bool) -> Vec<Join> {
    let mut joins = Vec::new();
    for (way, of_way) in network.ways().iter().enumerate() {
        let line = &of_way.line;
        for (at_m, is_end) in [(line.start_m(), false), (line.end_m(), true)] {
            if is_joined(way, at_m) {
                continue;
            }
            let (latitude_deg, longitude_deg) = line.position_at(at_m);
            let place_m = earth_centred(latitude_deg, longitude_deg);
            let mut nearby = Vec::new();
            network.nearby(&mut Surroundings::default(), place_m, |_| None, &mut nearby);
            for near in nearby {
                if near.way == way || near.foot.lateral_m > END_REACH_M {
                    continue;
                }
                // Beyond its ends a way is none; and none is left at its start or entered at its
                // end.
                let other = &network.ways()[near.way].line;
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
                joins.push(join(network, from, to));
            }
        }
    }
    joins
}

fn join(network: &Network, from: (usize, f64), to: (usize, f64)) -> Join {
    let (left, entered) = (&network.ways()[from.0].line, &network.ways()[to.0].line);
    Join {
        way: from.0,
        at_m: from.1,
        to_way: to.0,
        to_m: to.1,
        turns: from.1 < left.end_m() - END_REACH_M || to.1 > entered.start_m() + END_REACH_M,
    }
}

fn is_u_turn(network: &Network, join: &Join) -> bool {
    let [from, to] = [join.way, join.to_way].map(|way| network.ways()[way].name.as_ref());
    from.zip(to)
        .is_some_and(|(from, to)| from.way == to.way && from.direction != to.direction)
}

/// Lengths in whole micrometres, which have an order.
fn whole_um(length_m: f64) -> u64 {
    (length_m * 1e6).round() as u64
}
