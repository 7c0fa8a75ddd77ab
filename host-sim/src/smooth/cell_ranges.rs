//! Ranges of cells.

use std::ops::RangeInclusive;

/// Ranges of cells, in order, disjoint and not adjacent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellRanges(Vec<RangeInclusive<u32>>);

impl CellRanges {
    /// Returns whether no cell is in them.
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the cells from `since` to `cell`, which is not before any cell that was added.
    pub fn add(&mut self, mut since: u32, cell: u32) {
        while let Some(before) = self
            .0
            .pop_if(|before| before.end().saturating_add(1) >= since)
        {
            since = since.min(*before.start());
        }
        self.0.push(since..=cell);
    }

    /// Returns whether a cell is in one of them.
    pub fn contains(&self, cell: u32) -> bool {
        self.meet(&(cell..=cell))
    }

    /// Returns whether one of these cells is in one of them.
    pub fn meet(&self, cells: &RangeInclusive<u32>) -> bool {
        let next = self.0.partition_point(|range| range.end() < cells.start());
        self.0
            .get(next)
            .is_some_and(|range| range.start() <= cells.end())
    }

    /// Returns the ranges, in order.
    pub fn iter(&self) -> impl Iterator<Item = &RangeInclusive<u32>> {
        self.0.iter()
    }
}
