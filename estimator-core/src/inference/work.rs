//! What an update of the window is at.

use heapless::Vec;

/// What the window is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing: it waits for cells.
    None,
    /// Rounds, this many left. `ends` is whether the drive does.
    Rounds { left: u8, ends: bool },
    /// Rounds of the trial, this many left, before so many cells leave.
    Trial { left: u8, leaving: usize },
    /// The cells that leave, from this one on: the state before the window goes over them.
    Leave { at: usize },
}

/// Drops the first elements of a list.
pub(super) fn drop_first<T: Copy, const N: usize>(list: &mut Vec<T, N>, count: usize) {
    let left = list.len().saturating_sub(count);
    for at in 0..left {
        if let Some(later) = list.get(at + count).copied()
            && let Some(place) = list.get_mut(at)
        {
            *place = later;
        }
    }
    list.truncate(left);
}
