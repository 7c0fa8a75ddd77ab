//! The grade profile of a way from a place on.

use super::block::Block;
use super::block_cells::{CellGrade, Grades, ParkedGrades};
use super::packed_map::PackedMap;
use crate::cell::{CELL_LENGTH_M, Uncertain};
use libm::sqrtf;

/// The cells of a way, one after the other, from a place on.
#[derive(Clone, Debug)]
pub(super) struct Profile<'m> {
    map: PackedMap<'m>,
    block: Block<'m>,
    blocks_end: u32,
    grades: Grades<'m>,
    before: CellGrade,
    here: CellGrade,
}

/// A profile without its map.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParkedProfile {
    block: u32,
    grades: ParkedGrades,
    before: CellGrade,
    here: CellGrade,
}

impl ParkedProfile {
    /// Returns whether it leads to a cell of a block as a profile does that begins anew.
    pub(super) fn leads_to(&self, block: u32, cell: f32) -> bool {
        let is_begin = self.before.cell == self.here.cell;
        self.block == block && (is_begin || (self.before.cell as f32) < cell)
    }
}

impl<'m> Profile<'m> {
    /// Leaves the map.
    pub(super) const fn park(&self) -> ParkedProfile {
        ParkedProfile {
            block: self.block.offset,
            grades: self.grades.park(),
            before: self.before,
            here: self.here,
        }
    }

    /// Comes back to the map, whose block has not changed. The profile ends with the block.
    pub(super) fn resume(map: PackedMap<'m>, parked: &ParkedProfile) -> Option<Self> {
        let block = map.block_again(parked.block).ok()?;
        Some(Self {
            map,
            block,
            blocks_end: block.next,
            grades: block.grades_from(&parked.grades)?,
            before: parked.before,
            here: parked.here,
        })
    }

    /// Begins at a cell in a block of a way, or at the first cell behind it.
    pub(super) fn new(map: PackedMap<'m>, block: u32, cell: f32) -> Option<Self> {
        Self::in_block(map, map.block(block).ok()?, cell)
    }

    /// Begins at a cell in a block that was read before.
    pub(super) fn again(map: PackedMap<'m>, block: u32, cell: f32) -> Option<Self> {
        Self::in_block(map, map.block_again(block).ok()?, cell)
    }

    fn in_block(map: PackedMap<'m>, block: Block<'m>, cell: f32) -> Option<Self> {
        let blocks_end = map.way(block.way).ok()?.blocks_end;
        let mut grades = block.grades().ok()?;
        let here = grades.next()?;
        let mut profile = Self {
            map,
            block,
            blocks_end,
            grades,
            before: here,
            here,
        };
        profile.seek(cell).then_some(profile)
    }

    /// Returns the way.
    pub(super) const fn way(&self) -> u32 {
        self.block.way
    }

    /// Moves forward to the first cell at or behind this one. Returns false if the way ends before.
    pub(super) fn seek(&mut self, cell: f32) -> bool {
        while (self.here.cell as f32) < cell {
            if !self.step() {
                return false;
            }
        }
        true
    }

    /// Returns whether the profile need not go back to reach a cell.
    pub(super) fn is_before(&self, cell: f32) -> bool {
        self.before.cell as f32 <= cell
    }

    /// Returns the standard deviation of the grade of the last cell, %, without the error of the place,
    /// and its number of runs.
    pub(super) fn own_sigma(&self) -> (f32, u32) {
        (self.here.sigma_percent(), self.here.runs)
    }

    fn step(&mut self) -> bool {
        let next = self.grades.next().or_else(|| {
            if self.block.next >= self.blocks_end {
                return None;
            }
            self.block = self.map.block(self.block.next).ok()?;
            self.grades = self.block.grades().ok()?;
            self.grades.next()
        });
        match next {
            Some(next) => {
                self.before = self.here;
                self.here = next;
                true
            }
            None => false,
        }
    }

    /// Returns the grade at a place between the last two cells, %. `None` in a gap of the map. An
    /// error of the place by `sigma_m` changes the grade by as much as it changes along the road.
    pub(super) fn grade_percent(&self, cell: f32, sigma_m: f32) -> Option<Uncertain> {
        let (a, b) = (&self.before, &self.here);
        let cells = b.cell - a.cell;
        let part = if cells == 0 {
            1.0
        } else {
            (cell - a.cell as f32) / cells as f32
        };
        if cells > 1 || !(-0.5..=1.5).contains(&part) {
            return None;
        }
        let change = b.grade_percent() - a.grade_percent();
        let moved = change * sigma_m / CELL_LENGTH_M;
        let sigma = b.sigma_percent();
        Some(Uncertain {
            value: a.grade_percent() + part * change,
            sigma: sqrtf(sigma * sigma + moved * moved),
        })
    }
}
