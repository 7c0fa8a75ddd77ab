//! Cells that are finished later, and a drive on a map as one line.

use crate::digests::Digest;
use estimator_core::roadmap::{HorizonParts, MapLive, PackedMap};
use estimator_core::{Cell, Live};

/// Cells by which a finished cell lies behind the live one: the same in an estimator.
const LAG: usize = 200;

/// Returns the cells of a drive, each with the one that is finished at that time. `cells` has each as it
/// is live and as it is finished.
pub fn finished_late(cells: &[(Live, Cell)]) -> Vec<(Live, Option<Cell>)> {
    let finished = |at: usize| at.checked_sub(LAG).map(|before| cells[before].1);
    let live = cells.iter().enumerate();
    live.map(|(at, (live, _))| (*live, finished(at))).collect()
}

/// Drives on a map, and once more on another day. `cells` are those of [`finished_late`]. Returns how much
/// of the drive was on the map, where the map is shifted, and a digest of everything that it told.
pub fn line_on_map(map: PackedMap, name: &str, cells: &[(Live, Option<Cell>)]) -> String {
    let mut digest = Digest::default();
    let mut map = MapLive::new(map);
    let mut parts = HorizonParts::new();
    let (mut known, mut told) = (0, 0);
    for (live, finished) in cells.iter().chain(cells) {
        map.advance(live);
        let combined = map.combined_percent();
        known += u32::from(combined.is_some());
        digest.debug(&(combined, map.map_grade_percent(), map.trusted_place()));
        digest.debug(&map.matcher().hypotheses().collect::<Vec<_>>());
        let due: Vec<_> = parts.due_parts(&map, live).collect();
        told += due.len();
        digest.debug(&(due, parts.next_grade(live)));
        if let Some(finished) = finished {
            map.finish(finished);
            digest.debug(&map.shift_m());
        }
    }
    digest.debug(map.counters());
    let shift_m = map.shift_m();
    format!(
        "{name}: with the map in {known} cells, {told} parts, shift {:.1} ± {:.1} m, {:016x}",
        shift_m.value,
        shift_m.sigma,
        digest.value()
    )
}
