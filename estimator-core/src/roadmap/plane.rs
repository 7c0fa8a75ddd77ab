//! East and north of a place, m, and the lines of a plan view.

use super::block::{Block, MapPoint, Points};
use crate::angle::cos_deg;
use libm::sqrtf;

/// Length of 10⁻⁷ degrees of latitude, m.
const METRES_PER_E7: f32 = 0.011_12;
/// 10⁻⁷ degrees in degrees.
const DEGREES_PER_E7: f32 = 1e-7;
/// A turn, 10⁻⁷ degrees.
const TURN_E7: i64 = 3_600_000_000;

/// Returns the distance east and north from one place to another, m. Both are 10⁻⁷ degrees of
/// latitude and longitude, and near each other.
pub(super) fn metres_between(from: (i32, i32), to: (i32, i32)) -> [f32; 2] {
    metres_from(from, cosine_at(from), to)
}

/// Returns the cosine of the latitude of a place.
fn cosine_at(place: (i32, i32)) -> f32 {
    cos_deg(place.0 as f32 * DEGREES_PER_E7)
}

/// Returns the same as [`metres_between`], with the cosine of the latitude of the first place.
#[inline(never)] // Several places call it.
fn metres_from(from: (i32, i32), cosine: f32, to: (i32, i32)) -> [f32; 2] {
    let mut east = i64::from(to.1) - i64::from(from.1);
    if east > TURN_E7 / 2 {
        east -= TURN_E7;
    } else if east < -TURN_E7 / 2 {
        east += TURN_E7;
    }
    // Both fit into 32 bits now, from which a float unit converts.
    let (east, north) = (east as i32, to.0.saturating_sub(from.0));
    [
        east as f32 * METRES_PER_E7 * cosine,
        north as f32 * METRES_PER_E7,
    ]
}

/// Returns the sum of the products of the parts.
pub(super) fn dot(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns the length of a vector.
pub(super) fn length(vector: [f32; 2]) -> f32 {
    sqrtf(dot(vector, vector))
}

/// Returns the direction of a vector that is longer than `least`.
pub(super) fn direction(vector: [f32; 2], least: f32) -> Option<[f32; 2]> {
    let length = length(vector);
    (length > least).then(|| vector.map(|part| part / length))
}

/// A straight line of a plan view, from one point to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Cells from the first one of the block to the ends.
    pub(super) from_cells: f32,
    pub(super) to_cells: f32,
    /// Place of the first end, m from that of the first cell, and the way to the other end.
    from_m: [f32; 2],
    chord_m: [f32; 2],
}

/// A line with its direction, which takes a square root.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectedLine {
    line: Line,
    length_m: f32,
    /// Its direction.
    pub(super) direction: [f32; 2],
}

/// A position beside a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// How far the position lies ahead of a place on the line, m.
    pub(super) ahead_m: f32,
    /// How far it lies to the left, m.
    pub(super) left_m: f32,
    /// Direction of the line, east and north.
    pub(super) direction: [f32; 2],
}

impl Foot {
    /// Returns the distance of the position from the place, m.
    pub(super) fn distance_m(&self) -> f32 {
        length([self.ahead_m, self.left_m])
    }
}

impl Line {
    /// Returns false if a position is farther away than this in the direction of an axis.
    pub(super) fn is_near(&self, position_m: [f32; 2], reach_m: f32) -> bool {
        [0, 1].into_iter().all(|i| {
            let from_m = self.from_m[i] - position_m[i];
            let to_m = from_m + self.chord_m[i];
            !(from_m > reach_m && to_m > reach_m || from_m < -reach_m && to_m < -reach_m)
        })
    }

    pub(super) fn directed(self) -> DirectedLine {
        let length_m = length(self.chord_m);
        DirectedLine {
            line: self,
            length_m,
            direction: self.chord_m.map(|part| part / length_m),
        }
    }
}

impl DirectedLine {
    /// Returns a position, m from the first cell of the block, beside the place at this part of the
    /// line.
    pub(super) fn foot(&self, part: f32, position_m: [f32; 2]) -> Foot {
        let Line {
            from_m, chord_m, ..
        } = self.line;
        let off = [0, 1].map(|i| position_m[i] - (from_m[i] + part * chord_m[i]));
        Foot {
            ahead_m: dot(off, self.direction),
            left_m: off[1] * self.direction[0] - off[0] * self.direction[1],
            direction: self.direction,
        }
    }

    /// Returns the part of the line that is nearest to a position.
    pub(super) fn nearest_part(&self, position_m: [f32; 2]) -> f32 {
        let ahead_m = self.foot(0.0, position_m).ahead_m;
        (ahead_m / self.length_m).clamp(0.0, 1.0)
    }

    /// Returns the cells at this part of the line.
    pub(super) fn cells(&self, part: f32) -> f32 {
        let Line {
            from_cells,
            to_cells,
            ..
        } = self.line;
        from_cells + part * (to_cells - from_cells)
    }
}

/// The lines of a block. Those without length are left out.
#[derive(Clone, Debug)]
pub(super) struct Lines<'m> {
    first_cell: i32,
    origin: (i32, i32),
    /// Cosine of the latitude of the origin.
    cosine: f32,
    points: Points<'m>,
    from: (f32, [f32; 2]),
}

impl<'m> Lines<'m> {
    pub(super) fn of(block: &Block<'m>) -> Option<Self> {
        let mut points = block.points();
        let origin = place(&points.next()?);
        Some(Self {
            first_cell: block.first_cell,
            origin,
            cosine: cosine_at(origin),
            points,
            from: (0.0, [0.0; 2]),
        })
    }

    /// Returns a position as m from the first cell of the block.
    pub(super) fn metres(&self, position_e7: (i32, i32)) -> [f32; 2] {
        metres_from(self.origin, self.cosine, position_e7)
    }
}

impl Iterator for Lines<'_> {
    type Item = Line;

    fn next(&mut self) -> Option<Line> {
        loop {
            let point = self.points.next()?;
            let (from_cells, from_m) = self.from;
            let to_m = metres_from(self.origin, self.cosine, place(&point));
            let to_cells = (point.cell - self.first_cell) as f32;
            self.from = (to_cells, to_m);
            let chord_m = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
            if dot(chord_m, chord_m) > 0.0 {
                return Some(Line {
                    from_cells,
                    to_cells,
                    from_m,
                    chord_m,
                });
            }
        }
    }
}

fn place(point: &MapPoint) -> (i32, i32) {
    (point.latitude_e7, point.longitude_e7)
}
