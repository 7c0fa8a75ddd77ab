//! What an update of the window is at.

use heapless::Vec;

/// What the window is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing: it waits for cells.
    None,
    /// A round over the newest cells. `ends` is whether the drive does.
    Newest { ends: bool },
    /// A round over all cells.
    All { ends: bool },
    /// The end of that round: what it has found is taken.
    Take { ends: bool },
    /// The cells whose lag is over are finished.
    Finish { ends: bool },
    /// A round of the trial.
    Trial,
    /// Its end.
    Decide,
    /// The cells that leave, from this one on: the state before the window goes over them.
    Leave { at: usize },
    /// They are dropped.
    Drop,
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
