//! Map matching: the way and distance of each point of a run.
//!
//! A hidden Markov model over the run, solved by Viterbi's algorithm (after Newson and Krumm,
//! "Hidden Markov map matching through noise and sparseness", 2009). The states of a position are
//! the nearby passes of ways in the same direction, and "off the road". A transition must agree
//! with the odometer; a change of ways needs a route of that length over their joins. A run
//! therefore stays on its own pass where a road comes near itself or crosses itself, and does not
//! enter crossing or parallel streets.

use crate::map::geometry::joins::Join;
use crate::map::geometry::network::Network;
use crate::map::geometry::plane::{LocalPlane, earth_centred};
use crate::map::geometry::road_index::Surroundings;
use crate::map::geometry::road_line::{COURSE_REACH_M, LATERAL_LIMIT_M};
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
/// Positions farther apart than this by odometer give no course, m.
const COURSE_GAP_M: f64 = 30.0;
/// Minimum distance of the positions for a course, m.
const COURSE_SPAN_M: f64 = 10.0;

/// Most passes of roads near a position. Junctions have about ten.
const MOST_PASSES: usize = 64;

/// One point of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Driven distance, m; does not decrease.
    pub odometer_m: f64,
    /// Latitude and longitude, deg.
    pub position: Option<(f64, f64)>,
}

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

/// Matches each point of a run to the network.
pub fn match_track(network: &Network, track: &[TrackPoint]) -> Vec<MatchedPlace> {
    let mut places = vec![MatchedPlace::NoPosition; track.len()];
    let fixes: Vec<PositionedPoint> = track
        .iter()
        .enumerate()
        .filter_map(|(index, point)| {
            let (latitude_deg, longitude_deg) = point.position?;
            Some(PositionedPoint {
                index,
                odometer_m: point.odometer_m,
                place_m: earth_centred(latitude_deg, longitude_deg),
            })
        })
        .collect();
    let mut surroundings = Surroundings::default();
    let mut nearby = Nearby::with_room(fixes.len());
    for (fix, chord) in fixes.iter().zip(chords(&fixes)) {
        let along = &mut nearby.along;
        let course = |plane: &LocalPlane| course(chord, plane);
        let before = along.len();
        let opposite = network.nearby(&mut surroundings, fix.place_m, course, along);
        nearest_only(along, before);
        nearby.opposite.push(opposite);
        nearby.ends.push(along.len());
    }
    let states = best_states(network, &fixes, &nearby);
    for (i, state) in states.into_iter().enumerate() {
        places[fixes[i].index] = match nearby.along(i).get(state) {
            Some(candidate) => MatchedPlace::OnRoad {
                way: candidate.way,
                distance_m: candidate.foot.distance_m,
            },
            None if nearby.opposite[i] => MatchedPlace::Opposite,
            None => MatchedPlace::OffRoad,
        };
    }
    places
}

/// Keeps the nearest passes from `begin` on, in their order. Their number enters the cost of a step
/// squared.
fn nearest_only(along: &mut Vec<WayCandidate>, begin: usize) {
    let passes = &along[begin..];
    if passes.len() <= MOST_PASSES {
        return;
    }
    let mut offsets: Vec<f64> = passes.iter().map(|pass| pass.foot.lateral_m).collect();
    offsets.sort_by(f64::total_cmp);
    let farthest_m = offsets[MOST_PASSES - 1];
    let mut kept: Vec<WayCandidate> = along.drain(begin..).collect();
    kept.retain(|pass| pass.foot.lateral_m <= farthest_m);
    kept.truncate(MOST_PASSES);
    along.append(&mut kept);
}

/// A point of the run that has a position.
struct PositionedPoint {
    index: usize,
    odometer_m: f64,
    /// Earth-centred position, m.
    place_m: [f64; 3],
}

/// Passes of ways near each position.
struct Nearby {
    /// Passes in the same direction, position by position.
    along: Vec<WayCandidate>,
    /// End of the passes of each position.
    ends: Vec<usize>,
    /// True if a way has the opposite direction there.
    opposite: Vec<bool>,
}

impl Nearby {
    /// Reserves memory for one way per position.
    fn with_room(positions: usize) -> Self {
        Self {
            along: Vec::with_capacity(positions),
            ends: Vec::with_capacity(positions),
            opposite: Vec::with_capacity(positions),
        }
    }

    fn along(&self, i: usize) -> &[WayCandidate] {
        &self.along[self.begin(i)..self.ends[i]]
    }

    fn begin(&self, i: usize) -> usize {
        i.checked_sub(1).map_or(0, |before| self.ends[before])
    }
}

/// Returns, for each position, the positions from about 20 m before it to 20 m after it, without a
/// gap.
fn chords(fixes: &[PositionedPoint]) -> impl Iterator<Item = &[PositionedPoint]> {
    let apart_m = |a: usize, b: usize| fixes[b].odometer_m - fixes[a].odometer_m;
    let (mut from, mut to) = (0, 0);
    (0..fixes.len()).map(move |i| {
        if i > 0 && apart_m(i - 1, i) > COURSE_GAP_M {
            from = i;
        }
        while from < i && apart_m(from + 1, i) >= COURSE_REACH_M {
            from += 1;
        }
        to = to.max(i);
        while to + 1 < fixes.len()
            && apart_m(i, to) < COURSE_REACH_M
            && apart_m(to, to + 1) <= COURSE_GAP_M
        {
            to += 1;
        }
        &fixes[from..=to]
    })
}

/// Returns the direction of the run from the first to the last of these positions, in a plane;
/// `None` if they do not define one.
fn course(fixes: &[PositionedPoint], plane: &LocalPlane) -> Option<[f64; 2]> {
    let (first, last) = (fixes.first()?, fixes.last()?);
    let span_m = last.odometer_m - first.odometer_m;
    if span_m < COURSE_SPAN_M {
        return None;
    }
    let (a, b) = (plane.point(first.place_m)?, plane.point(last.place_m)?);
    let chord = [b[0] - a[0], b[1] - a[1]];
    // A chord far shorter than the driven distance is a turn on the spot or a receiver at
    // standstill.
    (chord[0].hypot(chord[1]) >= 0.5 * span_m).then_some(chord)
}

/// Returns the cost of a transition between two places over this distance by odometer, and the
/// joins between them. The cost is infinite if there is no route.
pub(crate) fn step(
    network: &Network,
    from: (usize, f64),
    to: (usize, f64),
    driven_m: f64,
) -> (f64, Vec<Join>) {
    let slip_m = SLIP_M + SLIP_RATIO * driven_m;
    let direct = if from.0 == to.0 {
        ((to.1 - from.1 - driven_m) / slip_m).powi(2)
    } else {
        f64::INFINITY
    };
    if direct <= 1.0 {
        return (direct, Vec::new());
    }
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

/// Returns the best state of each position: the index of a pass in `along`, or their number for
/// "off".
fn best_states(network: &Network, fixes: &[PositionedPoint], nearby: &Nearby) -> Vec<usize> {
    // The states of all positions, in order; each position has one more than passes.
    let mut lattice: Vec<LatticeState> = Vec::with_capacity(2 * fixes.len());
    let begin = |i: usize| nearby.begin(i) + i;
    for i in 0..fixes.len() {
        let near = nearby.along(i);
        for state in 0..=near.len() {
            let (cost, before) = match i.checked_sub(1) {
                None => (0.0, 0),
                Some(previous) => cheapest(
                    network,
                    &lattice[begin(previous)..begin(i)],
                    nearby.along(previous),
                    near.get(state),
                    fixes[i].odometer_m - fixes[previous].odometer_m,
                ),
            };
            lattice.push(LatticeState {
                cost: cost + stay_price(near.get(state)),
                before,
            });
        }
    }
    let mut chosen = vec![0; fixes.len()];
    let last = fixes.len().saturating_sub(1);
    let mut state = index_of_least(&lattice[begin(last)..]);
    for i in (0..chosen.len()).rev() {
        chosen[i] = state;
        state = lattice[begin(i) + state].before;
    }
    chosen
}

/// Returns the cost of the lateral offset, which grows with its square up to that of being off the
/// road.
fn stay_price(place: Option<&WayCandidate>) -> f64 {
    place.map_or(1.0, |candidate| {
        let turning = if candidate.turning {
            TURNING_PRICE
        } else {
            0.0
        };
        (candidate.foot.lateral_m / LATERAL_LIMIT_M).powi(2) + turning
    })
}

/// Returns the least cost to reach a place, or "off", and the previous state. "Off" can always be
/// reached and left, so a path always exists.
fn cheapest(
    network: &Network,
    states: &[LatticeState],
    before: &[WayCandidate],
    place: Option<&WayCandidate>,
    driven_m: f64,
) -> (f64, usize) {
    let mut best = (f64::INFINITY, 0);
    for (state, from) in states.iter().enumerate() {
        let step = match (before.get(state), place) {
            (None, None) => 0.0,
            (Some(a), Some(b)) => step(network, place_of(a), place_of(b), driven_m).0,
            _ => SWITCH_PRICE,
        };
        if from.cost + step < best.0 {
            best = (from.cost + step, state);
        }
    }
    best
}

fn place_of(candidate: &WayCandidate) -> (usize, f64) {
    (candidate.way, candidate.foot.distance_m)
}

fn index_of_least(states: &[LatticeState]) -> usize {
    (0..states.len())
        .min_by(|&a, &b| states[a].cost.total_cmp(&states[b].cost))
        .unwrap_or(0)
}
