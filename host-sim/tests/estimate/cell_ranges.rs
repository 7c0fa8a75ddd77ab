//! Ranges of cells, as corrections of the whole run name them.

use host_sim::smooth::CellRanges;
use std::ops::RangeInclusive;

fn ranges(added: &[(u32, u32)]) -> Vec<RangeInclusive<u32>> {
    let mut ranges = CellRanges::default();
    for &(since, cell) in added {
        ranges.add(since, cell);
    }
    ranges.iter().cloned().collect()
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
