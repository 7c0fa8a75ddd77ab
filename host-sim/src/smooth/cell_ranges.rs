//! Ranges of cells.

use std::ops::RangeInclusive;

/// Ranges of cells, in order, disjoint and not adjacent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellRanges(Vec<RangeInclusive<u32>>);

impl CellRanges {
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the cells from `since` to `cell`, which is not before any cell that was added.
    pub(super) fn add(&mut self, mut since: u32, cell: u32) {
        while let Some(before) = self
            .0
            .pop_if(|before| before.end().saturating_add(1) >= since)
        {
            since = since.min(*before.start());
        }
        self.0.push(since..=cell);
    }

    pub(super) fn contains(&self, cell: u32) -> bool {
        let next = self.0.partition_point(|range| *range.end() < cell);
        self.0.get(next).is_some_and(|range| range.contains(&cell))
    }

    /// Returns the ranges, in order.
    pub fn iter(&self) -> impl Iterator<Item = &RangeInclusive<u32>> {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(added: &[(u32, u32)]) -> Vec<RangeInclusive<u32>> {
        let mut ranges = CellRanges::default();
        for &(since, cell) in added {
            ranges.add(since, cell);
        }
        ranges.0
    }

    #[test]
    fn ranges_that_overlap_or_touch_are_one() {
        assert_eq!(ranges(&[(3, 5), (5, 9)]), [3..=9]);
        assert_eq!(ranges(&[(3, 5), (6, 9)]), [3..=9]);
        assert_eq!(ranges(&[(3, 5), (7, 9)]), [3..=5, 7..=9]);
        assert_eq!(ranges(&[(3, 5), (7, 9), (2, 12)]), [2..=12]);
        assert_eq!(ranges(&[(3, 5), (7, 9), (8, 12)]), [3..=5, 7..=12]);
        assert_eq!(ranges(&[(0, u32::MAX), (1, u32::MAX)]), [0..=u32::MAX]);
    }

    #[test]
    fn a_range_contains_its_ends() {
        let mut found = CellRanges::default();
        found.add(3, 5);
        found.add(9, 9);
        let contained: Vec<u32> = (0..12).filter(|cell| found.contains(*cell)).collect();
        assert_eq!(contained, [3, 4, 5, 9]);
    }
}
