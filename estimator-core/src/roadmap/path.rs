//! A place that moves along the ways of a map: one hypothesis of where the vehicle is.

use super::block::Block;
use super::map_error::MapError;
use super::packed_map::{Join, Joins, MapWay, PackedMap};
use crate::cell::CELL_LENGTH_M;
use libm::{cosf, sqrtf};

/// Length of 10⁻⁷ degrees of latitude, m.
const METRES_PER_E7: f32 = 0.011_12;
/// 10⁻⁷ degrees in radians.
const RADIANS_PER_E7: f32 = 1.745_329_3e-9;
/// A turn, 10⁻⁷ degrees.
const TURN_E7: i64 = 3_600_000_000;

/// A place on a way, with how well positions have fitted it.
#[derive(Clone, Debug)]
pub(super) struct Path<'m> {
    /// The block in which it is, or the next one behind a gap.
    pub(super) block: Block<'m>,
    /// Cells from the first cell of the block on; negative in a gap before it.
    pub(super) at_cells: f32,
    /// Mean squared misfit of the last positions, in their standard deviations.
    pub(super) misfit: f32,
    /// Distance over which positions have been compared, m.
    pub(super) matched_m: f32,
    /// Comparisons since it was made, or left another way.
    pub(super) compared: u8,
    /// Directions of the way at the last two comparisons.
    pub(super) directions: [[f32; 2]; 2],
    blocks_end: u32,
    joins: Joins<'m>,
    next_join: Option<Join>,
}

/// A position in the frame of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// How far the position lies ahead of the place, m.
    pub(super) ahead_m: f32,
    /// How far it lies to the left, m.
    pub(super) left_m: f32,
    /// Direction of the way, east and north.
    pub(super) direction: [f32; 2],
}

/// What became of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moved {
    /// It is on its way.
    On,
    /// Its way has ended.
    Ended,
}

/// Returns the distance east and north from one place to another, m. Both are 10⁻⁷ degrees of
/// latitude and longitude, and near each other.
pub(super) fn metres_between(from: (i32, i32), to: (i32, i32)) -> [f32; 2] {
    let mut east = i64::from(to.1) - i64::from(from.1);
    if east > TURN_E7 / 2 {
        east -= TURN_E7;
    } else if east < -TURN_E7 / 2 {
        east += TURN_E7;
    }
    let north = (i64::from(to.0) - i64::from(from.0)) as f32 * METRES_PER_E7;
    let cosine = cosf(from.0 as f32 * RADIANS_PER_E7);
    [east as f32 * METRES_PER_E7 * cosine, north]
}

impl<'m> Path<'m> {
    /// Creates a path at a cell of a way, given by the first block that ends at or behind it.
    pub(super) fn new(
        map: &PackedMap<'m>,
        way: u32,
        block: u32,
        cell: f32,
    ) -> Result<Self, MapError> {
        let block = map.block(block)?;
        Self::in_block(map, &map.way(way)?, block, cell - block.first_cell as f32)
    }

    /// Creates a path in a block of a way.
    pub(super) fn in_block(
        map: &PackedMap<'m>,
        way: &MapWay<'m>,
        block: Block<'m>,
        at_cells: f32,
    ) -> Result<Self, MapError> {
        if block.way != way.offset {
            return Err(MapError::Content);
        }
        let mut path = Self {
            block,
            at_cells,
            misfit: 0.0,
            matched_m: 0.0,
            compared: 0,
            directions: [[0.0; 2]; 2],
            blocks_end: way.blocks_end,
            joins: map.joins(way),
            next_join: None,
        };
        let here = path.cell();
        path.take_join();
        while path
            .next_join
            .is_some_and(|join| (join.at_cell as f32) < here)
        {
            path.take_join();
        }
        Ok(path)
    }

    /// Returns where it is: the number of a cell, and a part of one.
    pub(super) fn cell(&self) -> f32 {
        self.block.first_cell as f32 + self.at_cells
    }

    /// Moves on by some cells. Calls `fork` with each join on the way, and the cells beyond it.
    pub(super) fn advance(
        &mut self,
        map: &PackedMap<'m>,
        cells: f32,
        mut fork: impl FnMut(&Join, f32),
    ) -> Moved {
        self.at_cells += cells;
        let here = self.cell();
        while let Some(join) = self.next_join.filter(|join| (join.at_cell as f32) <= here) {
            fork(&join, here - join.at_cell as f32);
            self.take_join();
        }
        while self.at_cells > f32::from(self.block.count - 1) {
            if self.block.next >= self.blocks_end {
                return Moved::Ended;
            }
            let Ok(next) = map.block(self.block.next) else {
                return Moved::Ended;
            };
            // Distances between cells are whole numbers: nothing is lost.
            self.at_cells -= (next.first_cell - self.block.first_cell) as f32;
            self.block = next;
            if self.at_cells < 0.0 {
                break;
            }
        }
        Moved::On
    }

    /// Returns a position in the frame of the path; `None` in a gap of the map.
    pub(super) fn foot(&self, position_e7: (i32, i32)) -> Option<Foot> {
        let mut points = self.block.points();
        let start = points.next()?;
        let origin = (start.latitude_e7, start.longitude_e7);
        let mut from = (0.0, [0.0; 2]);
        let at = self.at_cells;
        let mut segment = None;
        for point in points {
            let cells = (point.cell - self.block.first_cell) as f32;
            let to = (
                cells,
                metres_between(origin, (point.latitude_e7, point.longitude_e7)),
            );
            segment = Some((from, to));
            if cells >= at {
                break;
            }
            from = to;
        }
        let ((from_cells, from_m), (to_cells, to_m)) = segment?;
        if at < -1.0 || at > to_cells + 1.0 {
            return None;
        }
        let chord = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
        let length = sqrtf(chord[0] * chord[0] + chord[1] * chord[1]);
        if length <= 0.0 {
            return None;
        }
        let direction = chord.map(|part| part / length);
        let part = (at - from_cells) / (to_cells - from_cells);
        let position = metres_between(origin, position_e7);
        let off = [0, 1].map(|i| position[i] - (from_m[i] + part * chord[i]));
        Some(Foot {
            ahead_m: off[0] * direction[0] + off[1] * direction[1],
            left_m: off[1] * direction[0] - off[0] * direction[1],
            direction,
        })
    }

    /// Returns the direction of the chord of the way over the last two comparisons, and takes that of
    /// this one.
    pub(super) fn chord(&mut self, direction: [f32; 2]) -> [f32; 2] {
        let [a, b] = self.directions;
        self.directions = [b, direction];
        let sum = [0, 1].map(|i| 0.5 * a[i] + b[i] + 0.5 * direction[i]);
        let length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1]);
        if length > 0.5 {
            sum.map(|part| part / length)
        } else {
            direction
        }
    }

    /// Returns whether another path is at the same place, within some cells.
    pub(super) fn is_at(&self, other: &Self, cells: f32) -> bool {
        self.block.way == other.block.way && (self.cell() - other.cell()).abs() < cells
    }

    fn take_join(&mut self) {
        self.next_join = self.joins.next().and_then(Result::ok);
    }
}

/// Returns the place on a block that is nearest to a position, as cells from its first cell, and the
/// position in its frame. Segments that do not lead in the direction of travel do not count.
pub(super) fn nearest_place(
    block: &Block<'_>,
    position_e7: (i32, i32),
    course: [f32; 2],
    least_cosine: f32,
) -> Option<(f32, Foot)> {
    let mut points = block.points();
    let start = points.next()?;
    let origin = (start.latitude_e7, start.longitude_e7);
    let position = metres_between(origin, position_e7);
    let mut from = (0.0, [0.0; 2]);
    let mut best: Option<(f32, Foot)> = None;
    for point in points {
        let cells = (point.cell - block.first_cell) as f32;
        let to = metres_between(origin, (point.latitude_e7, point.longitude_e7));
        let chord = [to[0] - from.1[0], to[1] - from.1[1]];
        let length = sqrtf(chord[0] * chord[0] + chord[1] * chord[1]);
        if length > 0.0 {
            let direction = chord.map(|part| part / length);
            let off = [position[0] - from.1[0], position[1] - from.1[1]];
            let along = off[0] * direction[0] + off[1] * direction[1];
            let on_m = along.clamp(0.0, length);
            let foot = Foot {
                ahead_m: along - on_m,
                left_m: off[1] * direction[0] - off[0] * direction[1],
                direction,
            };
            let cosine = direction[0] * course[0] + direction[1] * course[1];
            if cosine >= least_cosine && best.is_none_or(|(_, best)| foot.is_nearer_than(&best)) {
                best = Some((from.0 + (cells - from.0) * on_m / length, foot));
            }
        }
        from = (cells, to);
    }
    best
}

impl Foot {
    /// Returns the distance of the position from the place, m.
    pub(super) fn distance_m(&self) -> f32 {
        sqrtf(self.ahead_m * self.ahead_m + self.left_m * self.left_m)
    }

    fn is_nearer_than(&self, other: &Self) -> bool {
        self.distance_m() < other.distance_m()
    }
}

/// Returns the cells of a distance.
pub(super) fn cells_of(distance_m: f32) -> f32 {
    distance_m / CELL_LENGTH_M
}
