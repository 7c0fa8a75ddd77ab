//! Map matching: the way and distance of each point of a run.
//!
//! A hidden Markov model over the run, solved by Viterbi's algorithm (after Newson and Krumm,
//! "Hidden Markov map matching through noise and sparseness", 2009). The states of a position are
//! the nearby passes of ways in the same direction, and "off the road". A transition must agree
//! with the odometer; a change of ways needs a route of that length over their joins. A run
//! therefore stays on its own pass where a road comes near itself or crosses itself, and does not
//! enter crossing or parallel streets.

use super::candidates::Candidates;
use super::knots::{Knot, single_knots};
use super::track_point::TrackPoint;
use crate::map::geometry::joins::Join;
use crate::map::geometry::network::Network;
use crate::map::geometry::road_line::LATERAL_LIMIT_M;
use crate::map::geometry::way_index::WayCandidate;

/// Cost of leaving or entering the road, in positions off the road. A segment on the road must be
/// worth two of them, 100 m of perfect fit; shorter ones are crossings.
const SWITCH_PRICE: f64 = 20.0;
/// Difference between progress along the road and by odometer that costs as much as a position off
/// the road, m ...
const SLIP_M: f64 = 10.0;
/// ... plus this part of the distance (odometer scale, roads with straightened bends). The cost
/// grows with the square of the difference, so that a jump never costs less than leaving and
/// returning.
const SLIP_RATIO: f64 = 0.05;
/// Cost of a turn, in positions off the road: leaving a way that continues, or entering one that
/// began before. It prevents matches to a crossing street within a junction.
const TURN_PRICE: f64 = 1.0;
/// Cost of a position whose course only fits a turning vehicle.
const TURNING_PRICE: f64 = 0.5;

/// The match of one point of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MatchedPlace {
    /// On this way of the network (0 for a single road), at this distance along it, m.
    OnRoad {
        /// Index of the way.
        way: usize,
        /// Distance along it, m.
        distance_m: f64,
    },
    /// On the road, driving against its direction.
    Opposite,
    /// Off the road, or across it.
    OffRoad,
    /// Without a position.
    NoPosition,
}

impl MatchedPlace {
    /// Returns the way and the distance along it, m; `None` off the road.
    pub(crate) const fn on_road(self) -> Option<(usize, f64)> {
        match self {
            Self::OnRoad { way, distance_m } => Some((way, distance_m)),
            Self::Opposite | Self::OffRoad | Self::NoPosition => None,
        }
    }
}

/// Matches each point of a run to the network.
pub fn match_track(network: &Network, track: &[TrackPoint]) -> Vec<MatchedPlace> {
    let mut places = vec![MatchedPlace::NoPosition; track.len()];
    let knots = single_knots(track);
    let found = match_knots(network, &knots, &Candidates::of(network, &knots));
    for (knot, place) in knots.iter().zip(found) {
        places[knot.cells.start] = place;
    }
    places
}

/// Matches each knot of a run to the network.
pub(super) fn match_knots(
    network: &Network,
    knots: &[Knot],
    candidates: &Candidates,
) -> Vec<MatchedPlace> {
    let states = best_states(network, knots, candidates);
    let place = |(i, state): (usize, usize)| match candidates.along(i).get(state) {
        Some(candidate) => MatchedPlace::OnRoad {
            way: candidate.way,
            distance_m: candidate.foot.distance_m,
        },
        None if candidates.is_opposite(i) => MatchedPlace::Opposite,
        None => MatchedPlace::OffRoad,
    };
    states.into_iter().enumerate().map(place).collect()
}

/// Returns the cost of a transition between two places over this distance by odometer, and the
/// joins between them. The cost is infinite if there is no route.
pub(crate) fn step(
    network: &Network,
    from: (usize, f64),
    to: (usize, f64),
    driven_m: f64,
) -> (f64, Vec<Join>) {
    if let Some(direct) = direct_price(from, to, driven_m) {
        return (direct, Vec::new());
    }
    let slip_m = SLIP_M + SLIP_RATIO * driven_m;
    let direct = if from.0 == to.0 {
        ((to.1 - from.1 - driven_m) / slip_m).powi(2)
    } else {
        f64::INFINITY
    };
    // A longer one costs more than leaving the road and returning.
    let limit_m = driven_m + slip_m * (2.0 * SWITCH_PRICE).sqrt();
    let route = network.joins().route(from, to, driven_m, limit_m);
    match route.map(|route| {
        let turns = route.joins.iter().filter(|join| join.turns).count();
        let price = (route.mismatch_m / slip_m).powi(2) + TURN_PRICE * turns as f64;
        (price, route.joins)
    }) {
        Some(route) if route.0 < direct => route,
        _ => (direct, Vec::new()),
    }
}

/// A state of Viterbi's lattice.
struct LatticeState {
    cost: f64,
    /// Previous state on the path of least cost.
    before: usize,
}

/// Returns the best state of each knot: the index of a pass in `along`, or their number for "off".
fn best_states(network: &Network, knots: &[Knot], candidates: &Candidates) -> Vec<usize> {
    // The states of all knots, in order; each has one more than passes.
    let mut lattice: Vec<LatticeState> = Vec::with_capacity(2 * knots.len());
    let begin = |i: usize| candidates.begin(i) + i;
    for (i, knot) in knots.iter().enumerate() {
        let near = candidates.along(i);
        for state in 0..=near.len() {
            let (cost, before) = match i.checked_sub(1) {
                None => (0.0, 0),
                Some(previous) => cheapest(
                    network,
                    &lattice[begin(previous)..begin(i)],
                    candidates.along(previous),
                    near.get(state),
                    knot.odometer_m - knots[previous].odometer_m,
                ),
            };
            lattice.push(LatticeState {
                cost: cost + knot.weight() * stay_price(near.get(state)),
                before,
            });
        }
    }
    let mut chosen = vec![0; knots.len()];
    let last = knots.len().saturating_sub(1);
    let mut state = index_of_least(&lattice[begin(last)..]);
    for i in (0..chosen.len()).rev() {
        chosen[i] = state;
        state = lattice[begin(i) + state].before;
    }
    chosen
}

/// Returns the cost of the lateral offset of one position, which grows with its square up to that of
/// being off the road.
fn stay_price(place: Option<&WayCandidate>) -> f64 {
    place.map_or(1.0, |candidate| {
        let turning = if candidate.turning {
            TURNING_PRICE
        } else {
            0.0
        };
        candidate.foot.lateral_m2 / (LATERAL_LIMIT_M * LATERAL_LIMIT_M) + turning
    })
}

/// Returns the least cost to reach a place, or "off", and the previous state: the first of those
/// with this cost. "Off" can always be reached and left, so a path always exists.
fn cheapest(
    network: &Network,
    states: &[LatticeState],
    before: &[WayCandidate],
    place: Option<&WayCandidate>,
    driven_m: f64,
) -> (f64, usize) {
    let mut best = (f64::INFINITY, 0);
    let mut take = |cost: f64, state: usize| {
        if cost < best.0 || (cost == best.0 && state < best.1) {
            best = (cost, state);
        }
        best.0
    };
    // First the steps that need no route. They almost always cost less than all others do already.
    let mut least = f64::INFINITY;
    for (state, from) in states.iter().enumerate() {
        let price = match (before.get(state), place) {
            (None, None) => Some(0.0),
            (Some(a), Some(b)) => direct_price(place_of(a), place_of(b), driven_m),
            _ => Some(SWITCH_PRICE),
        };
        if let Some(price) = price {
            least = take(from.cost + price, state);
        }
    }
    let Some(b) = place else {
        return best;
    };
    for (state, (from, a)) in states.iter().zip(before).enumerate() {
        let (a, b) = (place_of(a), place_of(b));
        if from.cost <= least && direct_price(a, b, driven_m).is_none() {
            least = take(from.cost + step(network, a, b, driven_m).0, state);
        }
    }
    best
}

/// Returns the cost of a step along one way if no route can cost less.
fn direct_price(from: (usize, f64), to: (usize, f64), driven_m: f64) -> Option<f64> {
    let slip_m = SLIP_M + SLIP_RATIO * driven_m;
    let price = ((to.1 - from.1 - driven_m) / slip_m).powi(2);
    (from.0 == to.0 && price <= 1.0).then_some(price)
}

fn place_of(candidate: &WayCandidate) -> (usize, f64) {
    (candidate.way, candidate.foot.distance_m)
}

fn index_of_least(states: &[LatticeState]) -> usize {
    (0..states.len())
        .min_by(|&a, &b| states[a].cost.total_cmp(&states[b].cost))
        .unwrap_or(0)
}
