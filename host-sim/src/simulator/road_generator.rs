//! Generator of a realistic motorway: seeded vertical and horizontal alignment.
//!
//! The profile is a chain of tangents joined by vertical curves over which grade changes
//! linearly. Its rate of change stays below a limit, as sight distance demands: at 110 km/h a
//! crest has K = 74 m for one percent (AASHTO), that is 0.0135 % per m. The plan is a chain of
//! straights and arcs joined by clothoids. Grade and course return towards their initial values, so
//! the road neither climbs without limit nor turns back on itself.

use super::geodesy::Position;
use super::random::{Purpose, normal, stream};
use super::road::{Node, Road};
use crate::numeric::slope::sine;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use std::ops::Range;

/// Spacing of the nodes, m.
const NODE_STEP_M: f64 = 10.0;
/// Lengths of tangents between vertical curves, m.
const TANGENT_M: Range<f64> = 100.0..600.0;
/// Rate of change of grade in a vertical curve, as a part of the largest one.
const CURVE_SHARPNESS: Range<f64> = 0.3..1.0;
/// Height above the start at which the mean grade is down by one standard deviation, m.
const ALTITUDE_RETURN_M: f64 = 40.0;
/// Lengths of straights and arcs, m.
const ARC_M: Range<f64> = 200.0..1_200.0;
/// Lengths of clothoids, m.
const CLOTHOID_M: Range<f64> = 80.0..200.0;
/// Largest turn of one arc, rad. Tight arcs are short, so the road does not cross itself.
const LONGEST_TURN_RAD: f64 = 0.8;
/// Fraction of straight pieces.
const STRAIGHT_PART: f64 = 0.4;
/// Curvature of an arc, as a part of the largest one.
const ARC_SHARPNESS: Range<f64> = 0.15..1.0;
/// Deviation from the initial course above which arcs turn back, rad.
const COURSE_RETURN_RAD: f64 = 0.35;

/// Parameters of a generated road.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoadShape {
    /// Length of the surface, m, 100 to 1e6, default 40 000.
    pub length_m: f64,
    /// Standard deviation of the grade of the tangents, %, 0 to 10, default 1.4.
    pub grade_sigma_percent: f64,
    /// Largest grade, up or down, %, 0 to 15, default 5.
    pub largest_grade_percent: f64,
    /// Largest change of grade with distance, %/m, 1e-4 to 0.2, default 0.0135.
    pub largest_change_percent_per_m: f64,
    /// Radius of the tightest arc, m, 100 to 1e6, default 1500.
    pub smallest_radius_m: f64,
    /// Radius of the widest arc, m, at least 1.01 times the tightest; default 1/0.15 of the
    /// tightest.
    pub largest_radius_m: Option<f64>,
    /// Latitude of the start, deg.
    pub start_latitude_deg: f64,
    /// Longitude of the start, deg.
    pub start_longitude_deg: f64,
    /// Altitude of the start, m.
    pub start_altitude_m: f64,
    /// Course at the start, deg clockwise from north.
    pub start_course_deg: f64,
}

impl Default for RoadShape {
    /// Returns 40 km as between Södertälje and Nyköping, where the thesis measured.
    fn default() -> Self {
        Self {
            length_m: 40_000.0,
            grade_sigma_percent: 1.4,
            largest_grade_percent: 5.0,
            largest_change_percent_per_m: 0.0135,
            smallest_radius_m: 1_500.0,
            largest_radius_m: None,
            start_latitude_deg: 59.14,
            start_longitude_deg: 17.62,
            start_altitude_m: 40.0,
            start_course_deg: 225.0,
        }
    }
}

/// Generates the road of a `seed`.
#[must_use]
pub fn generate(shape: &RoadShape, seed: u64) -> Road {
    let mut rng = stream(seed, 0, Purpose::Road);
    let grades = profile(shape, &mut rng);
    let curvatures = plan(shape, &mut rng);
    let mut nodes: Vec<Node> = Vec::new();
    let mut position = Position {
        latitude_deg: shape.start_latitude_deg,
        longitude_deg: shape.start_longitude_deg,
    };
    let mut course_rad = shape.start_course_deg.to_radians();
    let steps = (shape.length_m / NODE_STEP_M).ceil() as usize;
    for step in 0..=steps {
        let distance_m = (step as f64 * NODE_STEP_M).min(shape.length_m);
        let grade = 0.01 * value_at(&grades, distance_m);
        if let Some(last) = nodes.last() {
            let step_m = distance_m - last.distance_m;
            let turn = 0.5 * step_m * value_at(&curvatures, distance_m - 0.5 * step_m);
            // Half of the turn is before the step and half after it: the chord of the arc.
            course_rad += turn;
            let level_m = step_m * (1.0 - sine(0.5 * (grade + last.grade)).powi(2)).sqrt();
            position = position.moved(level_m * course_rad.cos(), level_m * course_rad.sin());
            course_rad += turn;
        }
        nodes.push(Node {
            distance_m,
            position,
            grade,
        });
    }
    Road::new(nodes, shape.start_altitude_m)
        .expect("at least two nodes at ascending distances were made")
}

/// A piece with a constant value, followed by a linear change to another value.
struct Piece {
    hold_m: f64,
    ramp_m: f64,
    target: f64,
}

/// Returns the nodes of grade (%) along the road.
fn profile(shape: &RoadShape, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    pieces(shape.length_m, |grade, climbed_percent_m| {
        let back = (-0.01 * climbed_percent_m / ALTITUDE_RETURN_M).clamp(-1.0, 1.0);
        let target = shape.grade_sigma_percent * (back + normal(rng));
        let target = target.clamp(-shape.largest_grade_percent, shape.largest_grade_percent);
        let rate = shape.largest_change_percent_per_m * rng.random_range(CURVE_SHARPNESS);
        Piece {
            hold_m: rng.random_range(TANGENT_M),
            ramp_m: (target - grade).abs() / rate,
            target,
        }
    })
}

/// Returns the nodes of curvature (1/m) along the road.
fn plan(shape: &RoadShape, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let least = shape
        .largest_radius_m
        .map_or(ARC_SHARPNESS.start, |largest_m| {
            shape.smallest_radius_m / largest_m
        });
    let sharpness = least..ARC_SHARPNESS.end;
    pieces(shape.length_m, |curvature_per_m, turned_rad| {
        let size = rng.random_range(sharpness.clone()) / shape.smallest_radius_m;
        let right = if turned_rad.abs() > COURSE_RETURN_RAD {
            turned_rad < 0.0
        } else {
            rng.random_bool(0.5)
        };
        let target = if rng.random_bool(STRAIGHT_PART) {
            0.0
        } else if right {
            size
        } else {
            -size
        };
        Piece {
            hold_m: rng
                .random_range(ARC_M)
                .min(LONGEST_TURN_RAD / curvature_per_m.abs()),
            ramp_m: rng.random_range(CLOTHOID_M),
            target,
        }
    })
}

/// Chains pieces from zero to the length of the road. `next` gets the value at the end of the last
/// piece and its integral.
fn pieces(length_m: f64, mut next: impl FnMut(f64, f64) -> Piece) -> Vec<(f64, f64)> {
    let (mut at_m, mut value, mut integral) = (0.0, 0.0, 0.0);
    let mut corners = vec![(at_m, value)];
    while at_m < length_m {
        let piece = next(value, integral);
        integral += value * piece.hold_m + 0.5 * (value + piece.target) * piece.ramp_m;
        corners.push((at_m + piece.hold_m, value));
        at_m += piece.hold_m + piece.ramp_m;
        value = piece.target;
        corners.push((at_m, value));
    }
    corners
}

/// Interpolates between nodes.
fn value_at(corners: &[(f64, f64)], at_m: f64) -> f64 {
    let after = corners
        .partition_point(|corner| corner.0 <= at_m)
        .clamp(1, corners.len() - 1);
    let (from, to) = (corners[after - 1], corners[after]);
    if to.0 > from.0 {
        from.1 + (at_m - from.0) / (to.0 - from.0) * (to.1 - from.1)
    } else {
        to.1
    }
}
