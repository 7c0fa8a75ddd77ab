//! The passes of ways near each knot of a run.

use super::knots::Knot;
use crate::map::geometry::network::Network;
use crate::map::geometry::plane::LocalPlane;
use crate::map::geometry::road_index::Surroundings;
use crate::map::geometry::road_line::COURSE_REACH_M;
use crate::map::geometry::way_index::WayCandidate;

/// Positions farther apart than this by odometer give no course, m.
const COURSE_GAP_M: f64 = 30.0;
/// Minimum distance of the positions for a course, m.
const COURSE_SPAN_M: f64 = 10.0;
/// Half a chord may be this much shorter, m: knots are 20 m apart but for rounding.
const COURSE_SLACK_M: f64 = 0.01;
/// Most passes of roads near a position. Junctions have about ten.
const MOST_PASSES: usize = 64;

/// Passes of ways near each knot.
#[derive(Default)]
pub(super) struct Candidates {
    /// Passes in the same direction, knot by knot.
    along: Vec<WayCandidate>,
    /// End of the passes of each knot.
    ends: Vec<usize>,
    /// True if a way has the opposite direction there.
    opposite: Vec<bool>,
}

impl Candidates {
    /// Finds the passes near these knots.
    pub(super) fn of(network: &Network, knots: &[Knot]) -> Self {
        Self::default().refined(network, knots, |_| None)
    }

    /// Finds the passes near these knots. Some of them were among the knots before: `before` gives
    /// their index there.
    pub(super) fn refined(
        &self,
        network: &Network,
        knots: &[Knot],
        before: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let mut found = Self::with_room(knots.len());
        let mut surroundings = Surroundings::default();
        for (i, (knot, chord)) in knots.iter().zip(chords(knots)).enumerate() {
            let along = &mut found.along;
            let opposite = if let Some(known) = before(i) {
                along.extend_from_slice(self.along(known));
                self.opposite[known]
            } else {
                let course = |plane: &LocalPlane| course(chord, plane);
                let begin = along.len();
                let opposite = network.nearby(&mut surroundings, knot.place_m, course, along);
                nearest_only(along, begin);
                opposite
            };
            found.opposite.push(opposite);
            found.ends.push(found.along.len());
        }
        found
    }

    /// Reserves memory for one way per knot.
    fn with_room(knots: usize) -> Self {
        Self {
            along: Vec::with_capacity(knots),
            ends: Vec::with_capacity(knots),
            opposite: Vec::with_capacity(knots),
        }
    }

    /// Returns the passes in the same direction near a knot.
    pub(super) fn along(&self, i: usize) -> &[WayCandidate] {
        &self.along[self.begin(i)..self.ends[i]]
    }

    /// Returns true if a way has the opposite direction near a knot.
    pub(super) fn is_opposite(&self, i: usize) -> bool {
        self.opposite[i]
    }

    /// Returns the number of passes near all knots before this one.
    pub(super) fn begin(&self, i: usize) -> usize {
        i.checked_sub(1).map_or(0, |before| self.ends[before])
    }
}

/// Keeps the nearest passes from `begin` on, in their order. Their number enters the cost of a step
/// squared.
fn nearest_only(along: &mut Vec<WayCandidate>, begin: usize) {
    let passes = &along[begin..];
    if passes.len() <= MOST_PASSES {
        return;
    }
    let mut offsets: Vec<f64> = passes.iter().map(|pass| pass.foot.lateral_m2).collect();
    offsets.sort_by(f64::total_cmp);
    let farthest_m2 = offsets[MOST_PASSES - 1];
    let mut kept: Vec<WayCandidate> = along.drain(begin..).collect();
    kept.retain(|pass| pass.foot.lateral_m2 <= farthest_m2);
    kept.truncate(MOST_PASSES);
    along.append(&mut kept);
}

/// Returns, for each knot, the knots from about 20 m before it to 20 m after it, without a gap.
fn chords(knots: &[Knot]) -> impl Iterator<Item = &[Knot]> {
    let apart_m = |a: usize, b: usize| knots[b].odometer_m - knots[a].odometer_m;
    let reach_m = COURSE_REACH_M - COURSE_SLACK_M;
    let (mut from, mut to) = (0, 0);
    (0..knots.len()).map(move |i| {
        if i > 0 && apart_m(i - 1, i) > COURSE_GAP_M {
            from = i;
        }
        while from < i && apart_m(from + 1, i) >= reach_m {
            from += 1;
        }
        to = to.max(i);
        while to + 1 < knots.len()
            && apart_m(i, to) < reach_m
            && apart_m(to, to + 1) <= COURSE_GAP_M
        {
            to += 1;
        }
        &knots[from..=to]
    })
}

/// Returns the direction of the run from the first to the last of these knots, in a plane; `None` if
/// they do not define one.
fn course(knots: &[Knot], plane: &LocalPlane) -> Option<[f64; 2]> {
    let (first, last) = (knots.first()?, knots.last()?);
    let span_m = last.odometer_m - first.odometer_m;
    if span_m < COURSE_SPAN_M {
        return None;
    }
    let (a, b) = (plane.point(first.place_m)?, plane.point(last.place_m)?);
    let chord = [b[0] - a[0], b[1] - a[1]];
    // A chord far shorter than the driven distance is a turn on the spot or a receiver at
    // standstill.
    let squared_m2 = chord[0] * chord[0] + chord[1] * chord[1];
    (squared_m2 >= 0.25 * span_m * span_m).then_some(chord)
}
