//! A road as a line on the ellipsoid.

use super::grid::GRID_M;
use super::plane::{LocalPlane, earth_centred};
use std::cmp::Ordering::Less;
use std::ops::RangeInclusive;

/// Half the chord of a course, m: long compared with position noise of 2-3 m, short compared with
/// bends. Runs and roads use the same value, so the chords of both cut corners by the same amount.
pub(crate) const COURSE_REACH_M: f64 = 20.0;
/// Maximum lateral offset of a position, m: position error, lanes, offset of the road data.
pub(crate) const LATERAL_LIMIT_M: f64 = 25.0;

/// Longest road or way, m: a million cells.
const LONGEST_M: f64 = 2.5e6;
/// Most points within a chord of a course.
const DENSEST: usize = 1_000;

/// One vertex of a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadPoint {
    /// Distance along the road, m; grows strictly.
    pub distance_m: f64,
    /// Latitude, deg.
    pub latitude_deg: f64,
    /// Longitude, deg.
    pub longitude_deg: f64,
}

/// Why points do not make a road. Points count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RoadProblem {
    /// There are fewer than two points.
    #[error("fewer than two points; expected a line")]
    TooFewPoints,
    /// The distance does not grow at this point.
    #[error("distance_m does not grow at point {0}; expected it to grow from point to point")]
    NotForward(usize),
    /// The road is too long for a map.
    #[error("{0:.0} km long; expected at most {most:.0} km", most = LONGEST_M / 1000.0)]
    TooLong(f64),
    /// There are too many points close together, from this point on.
    #[error(
        "more than {DENSEST} points within {span:.0} m from point {0} on; expected fewer",
        span = 2.0 * COURSE_REACH_M
    )]
    TooDense(usize),
    /// This point is beyond the range of the plane.
    #[error("point {0} is over 300 km from the middle of the road; expected a smaller road")]
    TooWide(usize),
}

/// A road in its direction of travel.
#[derive(Debug)]
pub struct RoadLine {
    plane: LocalPlane,
    points: Vec<RoadPoint>,
    plan: Vec<[f64; 2]>,
    /// Direction of the road around each point, in its plane.
    courses: Vec<[f64; 2]>,
}

impl RoadLine {
    /// Creates a road through these points.
    ///
    /// # Errors
    /// Returns an error for fewer than two points, distances that do not grow, or too large an
    /// extent.
    pub fn new(points: Vec<RoadPoint>) -> Result<Self, RoadProblem> {
        if points.len() < 2 {
            return Err(RoadProblem::TooFewPoints);
        }
        if let Some(i) = points
            .windows(2)
            .position(|pair| pair[0].distance_m.partial_cmp(&pair[1].distance_m) != Some(Less))
        {
            return Err(RoadProblem::NotForward(i + 1));
        }
        let length_m = points[points.len() - 1].distance_m - points[0].distance_m;
        if length_m > LONGEST_M {
            return Err(RoadProblem::TooLong(length_m / 1000.0));
        }
        if let Some(i) = points
            .windows(DENSEST + 1)
            .position(|near| near[DENSEST].distance_m - near[0].distance_m < 2.0 * COURSE_REACH_M)
        {
            return Err(RoadProblem::TooDense(i));
        }
        let middle = points[points.len() / 2];
        let plane = LocalPlane::around(middle.latitude_deg, middle.longitude_deg);
        let plan = points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                plane
                    .point(earth_centred(point.latitude_deg, point.longitude_deg))
                    .ok_or(RoadProblem::TooWide(i))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut road = Self {
            plane,
            points,
            plan,
            courses: Vec::new(),
        };
        road.courses = road
            .points
            .iter()
            .enumerate()
            .map(|(i, point)| road.course_at(point.distance_m, i))
            .collect();
        Ok(road)
    }

    /// Returns the distance of the start of the road, m.
    pub fn start_m(&self) -> f64 {
        self.points[0].distance_m
    }

    /// Returns the distance of the end of the road, m.
    pub fn end_m(&self) -> f64 {
        self.points[self.points.len() - 1].distance_m
    }

    /// Returns the indices of the cells on the road: their distances over 2.5 m.
    pub(crate) fn cell_numbers(&self) -> RangeInclusive<i64> {
        (self.start_m() / GRID_M).ceil() as i64..=(self.end_m() / GRID_M).floor() as i64
    }

    /// Returns the road as one point per cell, the form in which maps are stored.
    pub fn on_grid(&self) -> Vec<RoadPoint> {
        self.cell_numbers()
            .map(|number| {
                let distance_m = number as f64 * GRID_M;
                let (latitude_deg, longitude_deg) = self.position_at(distance_m);
                RoadPoint {
                    distance_m,
                    latitude_deg,
                    longitude_deg,
                }
            })
            .collect()
    }

    /// Returns latitude and longitude at a distance along the road, deg. Beyond an end they are
    /// those of the end.
    pub fn position_at(&self, distance_m: f64) -> (f64, f64) {
        let i = self
            .points
            .partition_point(|point| point.distance_m <= distance_m)
            .clamp(1, self.points.len() - 1)
            - 1;
        let part = self.part_before(distance_m, i);
        let (a, b) = (self.points[i], self.points[i + 1]);
        let turn = wrapped_deg(b.longitude_deg - a.longitude_deg);
        (
            a.latitude_deg + part * (b.latitude_deg - a.latitude_deg),
            wrapped_deg(a.longitude_deg + part * turn),
        )
    }

    /// Returns the points of the road.
    pub(crate) fn points(&self) -> &[RoadPoint] {
        &self.points
    }

    /// Returns the plane in which positions are compared.
    pub(crate) const fn plane(&self) -> &LocalPlane {
        &self.plane
    }

    /// Projects a point onto segment `i`; `None` if it is out of reach.
    pub(crate) fn project(&self, i: usize, point: [f64; 2]) -> Option<Foot> {
        let (a, b) = (self.plan[i], self.plan[i + 1]);
        let along = [b[0] - a[0], b[1] - a[1]];
        let to = [point[0] - a[0], point[1] - a[1]];
        let ahead = to[0] * along[0] + to[1] * along[1];
        let squared = along[0] * along[0] + along[1] * along[1];
        let beside = |part: f64| [to[0] - part * along[0], to[1] - part * along[1]];
        let squared_length = |[x, y]: [f64; 2]| x * x + y * y;
        // The nearest point of most segments is an end; that test needs no division. The tangent
        // continues beyond the ends of the road, so that cells do not accumulate at the end.
        let (part, nearest) = if squared == 0.0 || (ahead <= 0.0 && i > 0) {
            (0.0, to)
        } else if ahead >= squared && i + 2 < self.plan.len() {
            (1.0, beside(1.0))
        } else {
            let part = ahead / squared;
            (part, beside(part.clamp(0.0, 1.0)))
        };
        let nearest_square = squared_length(nearest);
        if nearest_square > LATERAL_LIMIT_M * LATERAL_LIMIT_M {
            return None;
        }
        let from_m = self.points[i].distance_m;
        let length_m = self.points[i + 1].distance_m - from_m;
        let is_beyond = !(0.0..=1.0).contains(&part);
        Some(Foot {
            distance_m: from_m + part * length_m,
            lateral_m2: if is_beyond {
                squared_length(beside(part))
            } else {
                nearest_square
            },
            segment: i,
            part,
        })
    }

    /// Returns the direction of the road at a projected position.
    pub(crate) fn course_of(&self, foot: &Foot) -> [f64; 2] {
        match foot.part {
            0.0 => self.courses[foot.segment],
            1.0 => self.courses[foot.segment + 1],
            _ => self.course_at(foot.distance_m, foot.segment),
        }
    }

    /// Returns the direction of the road around a distance, in its plane. The distance is at this
    /// point, or slightly behind it.
    fn course_at(&self, distance_m: f64, point: usize) -> [f64; 2] {
        let at_m = distance_m.clamp(self.start_m(), self.end_m());
        let (from, to) = (
            self.plan_at(at_m - COURSE_REACH_M, point),
            self.plan_at(at_m + COURSE_REACH_M, point),
        );
        [to[0] - from[0], to[1] - from[1]]
    }

    /// Returns the position at a distance. It searches the segment from a nearby point, which is
    /// faster than a search of the whole road.
    fn plan_at(&self, distance_m: f64, near: usize) -> [f64; 2] {
        let mut i = near.min(self.points.len() - 2);
        while i > 0 && self.points[i].distance_m > distance_m {
            i -= 1;
        }
        while i + 2 < self.points.len() && self.points[i + 1].distance_m <= distance_m {
            i += 1;
        }
        let part = self.part_before(distance_m, i);
        let (a, b) = (self.plan[i], self.plan[i + 1]);
        [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
    }

    /// Returns the part of a segment before a distance.
    fn part_before(&self, distance_m: f64, segment: usize) -> f64 {
        let [from_m, to_m] = [segment, segment + 1].map(|i| self.points[i].distance_m);
        ((distance_m - from_m) / (to_m - from_m)).clamp(0.0, 1.0)
    }
}

/// Projection of a position onto the road.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// Distance along the road, m. Beyond the ends it continues along the tangent.
    pub distance_m: f64,
    /// Square of the lateral offset, m²: roots of all offsets would take longer than the rest.
    pub lateral_m2: f64,
    segment: usize,
    /// The part of the segment before the projection.
    part: f64,
}

/// Wraps an angle to ±180°.
fn wrapped_deg(angle_deg: f64) -> f64 {
    (angle_deg + 180.0).rem_euclid(360.0) - 180.0
}
