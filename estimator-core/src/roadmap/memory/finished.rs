//! Finished cells that wait for their turn.

use super::fusion::Known;
use crate::time::Instant;
use heapless::Deque;

/// Most cells that wait: more than the shares of the longest work, the writing of three pages.
const MOST_WAITING: usize = 32;

/// Finished cells that wait, the oldest first.
pub(super) type Waiting = Deque<Finished, MOST_WAITING>;

/// A finished cell on a known way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) way: u32,
    pub(super) at: f32,
    pub(super) known: Known,
    /// Number of the driven cell.
    pub(super) number: u32,
}

/// What a finished cell is for the memory.
#[derive(Clone, Copy, Debug)]
pub(super) enum Finished {
    /// On a known way.
    OnWay(Placed, Instant),
    /// On a new road, with its number and its position.
    New(Known, u32, Option<(i32, i32)>, Instant),
    /// Left out.
    LeftOut(Instant),
    /// The end of a drive behind the cells before.
    DriveEnd,
}

impl Finished {
    /// Returns when the vehicle was there.
    pub(super) const fn time(&self) -> Option<Instant> {
        match self {
            Self::OnWay(_, time) | Self::New(_, _, _, time) | Self::LeftOut(time) => Some(*time),
            Self::DriveEnd => None,
        }
    }
}
