//! Which point of which way each point of a run belongs to.
//!
//! A hidden Markov model over the run, solved by Viterbi's algorithm (after Newson and Krumm,
//! "Hidden Markov map matching through noise and sparseness", 2009). The states at a position
//! are the passes of ways near it that go the same way, and "off the road"; passing from one to the
//! next must agree with the odometer, and from one way to another there must be a route of that
//! length over their joins. So a run stays on its own pass where a road comes near itself or
//! crosses itself, and a crossing or parallel street is not worth entering.

use crate::map::geometry::joins::Join;
use crate::map::geometry::network::Network;
use crate::map::geometry::plane::{LocalPlane, earth_centred};
use crate::map::geometry::road_index::Surroundings;
use crate::map::geometry::road_line::{COURSE_REACH_M, LATERAL_LIMIT_M};
use crate::map::geometry::way_index::Candidate;

/// Price of leaving the road or coming onto it, in positions off the road: a stretch on the road
/// must be worth two of them, 100 m of perfect fit, or it is a crossing.
const SWITCH_PRICE: f64 = 20.0;
/// Progress along the road and by odometer may differ by this for the price of a position off
/// the road, m ...
const SLIP_M: f64 = 10.0;
/// ... and by this part of the distance (odometer scale, roads with straightened bends). More
/// costs the square of it, so that a leap is never cheaper than leaving and coming back.
const SLIP_RATIO: f64 = 0.05;
/// Price of a turn: of leaving a way that goes on, or entering one that began before, in positions
/// off the road. So a crossing street is not taken for the width of a junction.
const TURN_PRICE: f64 = 1.0;
/// Price of a position whose course fits only as that of a vehicle that turns.
const TURNING_PRICE: f64 = 0.5;
/// Positions this far apart by odometer do not tell a course, m.
const COURSE_GAP_M: f64 = 30.0;
/// A course needs positions over at least this, m.
const COURSE_SPAN_M: f64 = 10.0;

/// One point of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Driven distance; does not decrease.
    pub odometer_m: f64,
    /// Latitude and longitude, deg.
    pub position: Option<(f64, f64)>,
}

/// Where one point of a run lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// On this way of the network (a single road is its way 0), at this distance along it, m.
    OnRoad { way: usize, distance_m: f64 },
    /// At the road, driving against its direction.
    Opposite,
    /// Not at the road, or across it.
    OffRoad,
    /// The run has no position here.
    NoPosition,
}

/// Places each point of a run on the network.
pub fn match_track(network: &Network, track: &[TrackPoint]) -> Vec<Place> {
    let mut places = vec![Place::NoPosition; track.len()];
    let fixes: Vec<Fix> = track
        .iter()
        .enumerate()
        .filter_map(|(index, point)| {
            let (latitude_deg, longitude_deg) = point.position?;
            Some(Fix {
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
        let opposite = network.nearby(&mut surroundings, fix.place_m, course, along);
        nearby.opposite.push(opposite);
        nearby.ends.push(along.len());
    }
    let states = best_states(network, &fixes, &nearby);
    for (i, state) in states.into_iter().enumerate() {
        places[fixes[i].index] = match nearby.along(i).get(state) {
            Some(candidate) => Place::OnRoad {
                way: candidate.way,
                distance_m: candidate.foot.distance_m,
            },
            None if nearby.opposite[i] => Place::Opposite,
            None => Place::OffRoad,
        };
    }
    places
}

/// A point of the run that has a position.
struct Fix {
    index: usize,
    odometer_m: f64,
    /// Earth-centred.
    place_m: [f64; 3],
}

/// What lies near each position.
struct Nearby {
    /// Passes of ways that go the same way, one position behind the other.
    along: Vec<Candidate>,
    /// Where those of each position end.
    ends: Vec<usize>,
    /// Whether a way goes the opposite way there.
    opposite: Vec<bool>,
}

impl Nearby {
    /// Mostly a position is on one way.
    fn with_room(positions: usize) -> Self {
        Self {
            along: Vec::with_capacity(positions),
            ends: Vec::with_capacity(positions),
            opposite: Vec::with_capacity(positions),
        }
    }

    fn along(&self, i: usize) -> &[Candidate] {
        &self.along[self.begin(i)..self.ends[i]]
    }

    fn begin(&self, i: usize) -> usize {
        i.checked_sub(1).map_or(0, |before| self.ends[before])
    }
}

/// For each position those from about 20 m before it to as far after it, without a gap between
/// them.
fn chords(fixes: &[Fix]) -> impl Iterator<Item = &[Fix]> {
    let way_m = |a: usize, b: usize| fixes[b].odometer_m - fixes[a].odometer_m;
    let (mut from, mut to) = (0, 0);
    (0..fixes.len()).map(move |i| {
        if i > 0 && way_m(i - 1, i) > COURSE_GAP_M {
            from = i;
        }
        while from < i && way_m(from + 1, i) >= COURSE_REACH_M {
            from += 1;
        }
        to = to.max(i);
        while to + 1 < fixes.len()
            && way_m(i, to) < COURSE_REACH_M
            && way_m(to, to + 1) <= COURSE_GAP_M
        {
            to += 1;
        }
        &fixes[from..=to]
    })
}

/// Direction of the run from the first to the last of these, in a plane; `None` where they do not
/// tell one.
fn course(fixes: &[Fix], plane: &LocalPlane) -> Option<[f64; 2]> {
    let (first, last) = (fixes.first()?, fixes.last()?);
    let span_m = last.odometer_m - first.odometer_m;
    if span_m < COURSE_SPAN_M {
        return None;
    }
    let (a, b) = (plane.point(first.place_m)?, plane.point(last.place_m)?);
    let chord = [b[0] - a[0], b[1] - a[1]];
    // A chord far shorter than the drive is a turn on the spot or a receiver that stands still.
    (chord[0].hypot(chord[1]) >= 0.5 * span_m).then_some(chord)
}

/// Price of passing from one place to another over this distance by odometer, and the joins on
/// the way; infinite where no way leads there.
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
    // What is longer costs more than leaving the road and coming back.
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

/// One state in Viterbi's lattice.
struct State {
    cost: f64,
    /// The state before, on the cheapest way here.
    before: usize,
}

/// For each position the index of its state: of a pass in `along`, or their number for "off".
fn best_states(network: &Network, fixes: &[Fix], nearby: &Nearby) -> Vec<usize> {
    // The states of all positions, one position behind the other; each has one more than places.
    let mut lattice: Vec<State> = Vec::with_capacity(2 * fixes.len());
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
            lattice.push(State {
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

/// Being beside the road grows dear with the square of the offset, up to being off it.
fn stay_price(place: Option<&Candidate>) -> f64 {
    place.map_or(1.0, |candidate| {
        let turning = if candidate.turning {
            TURNING_PRICE
        } else {
            0.0
        };
        (candidate.foot.lateral_m / LATERAL_LIMIT_M).powi(2) + turning
    })
}

/// Cost of the cheapest way to a place, or off the road, and the state before it. "Off" can always
/// be reached and left, so there always is one.
fn cheapest(
    network: &Network,
    states: &[State],
    before: &[Candidate],
    place: Option<&Candidate>,
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

fn place_of(candidate: &Candidate) -> (usize, f64) {
    (candidate.way, candidate.foot.distance_m)
}

fn index_of_least(states: &[State]) -> usize {
    (0..states.len())
        .min_by(|&a, &b| states[a].cost.total_cmp(&states[b].cost))
        .unwrap_or(0)
}
