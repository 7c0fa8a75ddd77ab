//! Joins of ways, and routes between ways.

use pathfinding::prelude::dijkstra_reach;
use std::ops::Range;
use std::sync::OnceLock;

/// Tolerance along the road, m: a position may be this far behind a join before the way is left
/// there, or before the join as the next way is entered.
const BACK_M: f64 = 10.0;
/// Routes up to this length between their first and their last join are known by the ways that they
/// lead to, m. Those of cells without a gap are shorter.
const NEAR_M: f64 = 200.0;

/// A join, from a point of one way to a point of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Join {
    pub way: usize,
    pub at_m: f64,
    pub to_way: usize,
    pub to_m: f64,
    /// True if the way continues, or the other begins before: taking the join is a choice.
    pub turns: bool,
}

/// The joins of a network.
#[derive(Debug, Default)]
pub(crate) struct Joins {
    /// Joins that leave each way, in order of distance.
    leaving: Vec<Vec<Join>>,
    /// Distances at which each way is left or entered.
    places: Vec<Vec<f64>>,
    /// The ways that routes of [`NEAR_M`] from each way lead to, in order; found when first asked for.
    near: Vec<OnceLock<Box<[usize]>>>,
}

/// A join in a route: its way, and its index among those that leave it.
type Taken = (usize, usize);

/// A route from a place on one way to a place on another, or on the same.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Route {
    /// Difference between its length and the driven distance, m.
    pub mismatch_m: f64,
    pub joins: Vec<Join>,
}

impl Joins {
    /// Creates the joins of `count` ways. They are in the order of their ways and distances.
    pub(crate) fn new(count: usize, joins: Vec<Join>) -> Self {
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
        Self {
            leaving,
            places,
            near: vec![OnceLock::new(); count],
        }
    }

    /// Returns the joins that leave each way, in order of distance.
    pub(crate) fn leaving(&self) -> &[Vec<Join>] {
        &self.leaving
    }

    /// Returns true if a way is left or entered within `reach_m` of a place on it.
    pub(crate) fn is_near(&self, way: usize, at_m: f64, reach_m: f64) -> bool {
        self.has_place(way, at_m - reach_m..at_m + reach_m)
    }

    /// Returns the route between two places whose length is nearest to the driven distance, among
    /// those up to `limit_m`.
    pub(crate) fn route(
        &self,
        from: (usize, f64),
        to: (usize, f64),
        driven_m: f64,
        limit_m: f64,
    ) -> Option<Route> {
        // One of these is almost always the result.
        if self.ahead(from.0, from.1 - BACK_M, limit_m).is_empty()
            || !self.has_place(to.0, to.1 - limit_m..to.1 + BACK_M)
            || (limit_m <= NEAR_M && self.ways_near(from.0).binary_search(&to.0).is_err())
        {
            return None;
        }
        // Nodes are the joins of the route, by way and index; the start is not one of them.
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

    /// Returns the ways that routes of up to [`NEAR_M`] behind their first join lead to, in order.
    fn ways_near(&self, way: usize) -> &[usize] {
        self.near[way].get_or_init(|| {
            let next = |&(way, k): &Taken| {
                let from = &self.leaving[way][k];
                let ahead = self.ahead(from.to_way, from.to_m - BACK_M, NEAR_M);
                ahead.map(move |k| {
                    let length_m = (self.leaving[from.to_way][k].at_m - from.to_m).max(0.0);
                    ((from.to_way, k), whole_um(length_m))
                })
            };
            let mut ways = Vec::new();
            for k in 0..self.leaving[way].len() {
                let reached = dijkstra_reach(&(way, k), next);
                let within = reached.take_while(|node| node.total_cost <= whole_um(NEAR_M));
                ways.extend(within.map(|node| {
                    let (way, k) = node.node;
                    self.leaving[way][k].to_way
                }));
            }
            ways.sort_unstable();
            ways.dedup();
            ways.into()
        })
    }

    /// Returns the joins up to a node, that of the node included.
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

    /// Returns the indices of the joins that leave a way within this distance.
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

/// Returns a length in whole micrometres, which are ordered.
fn whole_um(length_m: f64) -> u64 {
    (length_m * 1e6).round() as u64
}
