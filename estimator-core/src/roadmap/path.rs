//! A place that moves along the ways of a map: one hypothesis of where the vehicle is.

use super::block::Block;
use super::join::Join;
use super::joins::JoinCursor;
use super::map_error::MapError;
use super::packed_map::{MapWay, PackedMap};
use super::plane::{Foot, Line, Lines, direction, dot};
use crate::cell::CELL_LENGTH_M;

/// A place on a way, with how well positions have fitted it.
#[derive(Clone, Debug)]
pub(super) struct Path<'m> {
    /// The block in which it is, or the next one behind a gap.
    pub(super) block: Block<'m>,
    /// Cells from the first cell of the block on; negative in a gap before it.
    pub(super) at_cells: f32,
    pub(super) fit: Fit,
    blocks_end: u32,
    joins: JoinCursor,
    next_join: Option<Join>,
}

/// How well positions have fitted a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fit {
    /// Mean squared misfit of the last positions, in their standard deviations.
    pub(super) misfit: f32,
    /// Distance over which positions have been compared, m.
    pub(super) matched_m: f32,
    /// Comparisons since it was made, or left another way.
    pub(super) compared: u8,
    /// Directions of the way at the last two comparisons.
    pub(super) directions: [[f32; 2]; 2],
}

/// A path without its map: what it is while the map changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParkedPath {
    block: u32,
    at_cells: f32,
    fit: Fit,
    blocks_end: u32,
    joins: JoinCursor,
    next_join: Option<Join>,
}

/// What became of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moved {
    /// It is on its way.
    On,
    /// Its way has ended.
    Ended,
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
            fit: Fit::default(),
            blocks_end: way.blocks_end,
            joins: map
                .joins_from(way, block.first_cell as f32 + at_cells)
                .cursor,
            next_join: None,
        };
        path.take_join(map);
        Ok(path)
    }

    /// Leaves the map.
    pub(super) const fn park(&self) -> ParkedPath {
        ParkedPath {
            block: self.block.offset,
            at_cells: self.at_cells,
            fit: self.fit,
            blocks_end: self.blocks_end,
            joins: self.joins,
            next_join: self.next_join,
        }
    }

    /// Comes back to the map, in the same place; `None` if the map has it no more. If the map has not
    /// changed, its ways need not be read again.
    pub(super) fn resume(
        map: &PackedMap<'m>,
        parked: &ParkedPath,
        has_changed: bool,
    ) -> Option<Self> {
        let block = map.block_again(parked.block).ok()?;
        if !has_changed {
            return Some(Self {
                block,
                at_cells: parked.at_cells,
                fit: parked.fit,
                blocks_end: parked.blocks_end,
                joins: parked.joins,
                next_join: parked.next_join,
            });
        }
        let way = map.way(block.way).ok()?;
        let mut path = Self::in_block(map, &way, block, parked.at_cells).ok()?;
        path.fit = parked.fit;
        Some(path)
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
            self.take_join(map);
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

    /// Returns a position beside the place; `None` in a gap of the map.
    pub(super) fn foot(&self, position_e7: (i32, i32)) -> Option<Foot> {
        foot_at(&self.block, self.at_cells, position_e7)
    }

    /// Returns the direction of the chord of the way over the last two comparisons, and takes that of
    /// this one.
    pub(super) fn chord(&mut self, now: [f32; 2]) -> [f32; 2] {
        let [a, b] = self.fit.directions;
        self.fit.directions = [b, now];
        let sum = [0, 1].map(|i| 0.5 * a[i] + b[i] + 0.5 * now[i]);
        direction(sum, 0.5).unwrap_or(now)
    }

    /// Returns whether another path is at the same place, within some cells.
    pub(super) fn is_at(&self, other: &Self, cells: f32) -> bool {
        self.block.way == other.block.way && (self.cell() - other.cell()).abs() < cells
    }

    fn take_join(&mut self, map: &PackedMap<'m>) {
        self.next_join = self.joins.next(map).and_then(Result::ok);
    }
}

/// Returns a position beside a place on a block, given as cells from its first cell; `None` in a gap of
/// the map.
pub(super) fn foot_at(block: &Block<'_>, at: f32, position_e7: (i32, i32)) -> Option<Foot> {
    let mut lines = Lines::of(block)?;
    let position_m = lines.metres(position_e7);
    let mut line = lines.next()?;
    for next in lines {
        if line.to_cells >= at {
            break;
        }
        line = next;
    }
    if at < -1.0 || at > line.to_cells + 1.0 {
        return None;
    }
    let part = (at - line.from_cells) / (line.to_cells - line.from_cells);
    Some(line.directed().foot(part, position_m))
}

/// Returns the place on a block that is nearest to a position, as cells from its first cell, and the
/// position beside it. Lines that do not lead in the direction of travel do not count, nor do those
/// farther away than `reach_m`.
pub(super) fn nearest_place(
    block: &Block<'_>,
    position_e7: (i32, i32),
    course: [f32; 2],
    least_cosine: f32,
    reach_m: f32,
) -> Option<(f32, Foot)> {
    let lines = Lines::of(block)?;
    let position_m = lines.metres(position_e7);
    let nearest = lines
        // Most are far away. The direction of a line takes a square root.
        .filter(|line| line.is_near(position_m, reach_m))
        .map(Line::directed)
        .filter(|line| dot(line.direction, course) >= least_cosine)
        .map(|line| {
            let part = line.nearest_part(position_m);
            let foot = line.foot(part, position_m);
            (foot.distance_m(), line.cells(part), foot)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, at_cells, foot)| (at_cells, foot))
}

/// Returns the cells of a distance.
pub(super) fn cells_of(distance_m: f32) -> f32 {
    distance_m / CELL_LENGTH_M
}
