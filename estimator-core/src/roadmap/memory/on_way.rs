//! Whether a finished cell lies on the way that was found for it.

use super::history::{History, Was};
use super::view::MemoryView;
use crate::cell::Cell;
use crate::roadmap::path::foot_at;

/// Largest distance of a position from the way that the vehicle is on, m. Both have errors of 3 m.
const ASIDE_M: f32 = 12.0;

/// Returns where the vehicle was at the end of a cell. A position beside the way shows that it was
/// not on it yet, or no longer.
pub(super) fn verified(history: &History, roads: MemoryView<'_>, cell: &Cell) -> Was {
    let was = history.place(cell.end.cell);
    let (Was::On(way, at), Some(position_e7)) = (was, cell.end.position_e7) else {
        return was;
    };
    let foot = roads.block_at(way, at as i32).and_then(|block| {
        let block = roads.block(block, false).ok()?;
        foot_at(&block, at - block.first_cell as f32, position_e7)
    });
    match foot {
        Some(foot) if foot.left_m.abs() < ASIDE_M => was,
        _ => Was::Off,
    }
}
