//! The road: grade, altitude and plan view by distance.
//!
//! Grade is linear between nodes, so vertical curves are parabolas, as in road design. Altitude is
//! the integral of the sine of the slope, so the two are consistent.

use super::geodesy::{Position, wrapped_rad};
use crate::numeric::slope::sine;

/// A node of a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Distance along the surface of the road, m.
    pub distance_m: f64,
    /// Position.
    pub position: Position,
    /// Tangent of the slope angle.
    pub grade: f64,
}

/// A node with the quantities that follow from its neighbours.
#[derive(Clone, Copy, Debug)]
struct NodeGeometry {
    node: Node,
    altitude_m: f64,
    course_rad: f64,
    curvature_per_m: f64,
}

/// A road in one direction of travel, from 0 to its length.
#[derive(Clone, Debug)]
pub struct Road {
    points: Vec<NodeGeometry>,
}

impl Road {
    /// Creates a road through nodes of ascending distance; distances count from the first node.
    /// `None` with fewer than two nodes or distances that do not ascend.
    #[must_use]
    pub fn new(mut nodes: Vec<Node>, start_altitude_m: f64) -> Option<Self> {
        let start_m = nodes.first()?.distance_m;
        for node in &mut nodes {
            node.distance_m -= start_m;
        }
        if nodes.len() < 2 || !nodes.is_sorted_by(|a, b| a.distance_m < b.distance_m) {
            return None;
        }
        let mut altitude_m = start_altitude_m;
        let mut points: Vec<NodeGeometry> = Vec::with_capacity(nodes.len());
        for (index, node) in nodes.iter().enumerate() {
            if let Some(last) = points.last() {
                let length_m = node.distance_m - last.node.distance_m;
                altitude_m += climb_m(last.node.grade, node.grade, length_m);
            }
            let before = nodes[index.saturating_sub(1)];
            let after = nodes[(index + 1).min(nodes.len() - 1)];
            points.push(NodeGeometry {
                node: *node,
                altitude_m,
                course_rad: before.position.course_to_rad(after.position),
                curvature_per_m: 0.0,
            });
        }
        for index in 0..points.len() {
            let before = points[index.saturating_sub(1)];
            let after = points[(index + 1).min(points.len() - 1)];
            points[index].curvature_per_m = wrapped_rad(after.course_rad - before.course_rad)
                / (after.node.distance_m - before.node.distance_m);
        }
        Some(Self { points })
    }

    /// Returns the same road in the other direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let length_m = self.length_m();
        let points = self
            .points
            .iter()
            .rev()
            .map(|point| NodeGeometry {
                node: Node {
                    distance_m: length_m - point.node.distance_m,
                    grade: -point.node.grade,
                    ..point.node
                },
                course_rad: wrapped_rad(point.course_rad + std::f64::consts::PI),
                curvature_per_m: -point.curvature_per_m,
                ..*point
            })
            .collect();
        Self { points }
    }

    /// Returns the length of the surface, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.points.last().map_or(0.0, |last| last.node.distance_m)
    }

    /// Returns the nodes with their altitudes, m.
    pub fn nodes(&self) -> impl Iterator<Item = (Node, f64)> {
        self.points
            .iter()
            .map(|point| (point.node, point.altitude_m))
    }

    /// Returns the tangent of the slope angle, positive uphill. Beyond an end it is that of the
    /// end.
    #[must_use]
    pub fn grade(&self, distance_m: f64) -> f64 {
        let (from, to, part) = self.between(distance_m);
        from.node.grade + part * (to.node.grade - from.node.grade)
    }

    /// Returns the altitude, m.
    #[must_use]
    pub fn altitude_m(&self, distance_m: f64) -> f64 {
        let (from, to, part) = self.between(distance_m);
        let length_m = part * (to.node.distance_m - from.node.distance_m);
        let grade = from.node.grade + part * (to.node.grade - from.node.grade);
        from.altitude_m + climb_m(from.node.grade, grade, length_m)
    }

    /// Returns the position.
    #[must_use]
    pub fn position(&self, distance_m: f64) -> Position {
        let (from, to, part) = self.between(distance_m);
        from.node.position.towards(to.node.position, part)
    }

    /// Returns the direction of travel, rad clockwise from north, in -π to π.
    #[must_use]
    pub fn course_rad(&self, distance_m: f64) -> f64 {
        let (from, to, part) = self.between(distance_m);
        wrapped_rad(from.course_rad + part * wrapped_rad(to.course_rad - from.course_rad))
    }

    /// Returns the change of course with distance, rad/m, positive to the right.
    #[must_use]
    pub fn curvature_per_m(&self, distance_m: f64) -> f64 {
        let (from, to, part) = self.between(distance_m);
        from.curvature_per_m + part * (to.curvature_per_m - from.curvature_per_m)
    }

    /// Returns the nodes on either side, and the relative position between them.
    fn between(&self, distance_m: f64) -> (&NodeGeometry, &NodeGeometry, f64) {
        let after = self
            .points
            .partition_point(|point| point.node.distance_m <= distance_m)
            .clamp(1, self.points.len() - 1);
        let (from, to) = (&self.points[after - 1], &self.points[after]);
        let part =
            (distance_m - from.node.distance_m) / (to.node.distance_m - from.node.distance_m);
        (from, to, part.clamp(0.0, 1.0))
    }
}

/// Returns the altitude gained over `length_m` while the grade changes linearly from `from` to
/// `to`. Simpson's rule on the sine of the slope has an error below a micrometre per node.
fn climb_m(from: f64, to: f64, length_m: f64) -> f64 {
    let middle = 0.5 * (from + to);
    length_m / 6.0 * (sine(from) + 4.0 * sine(middle) + sine(to))
}
