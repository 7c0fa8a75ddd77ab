//! Fixed-lag smoothing in fixed memory.
//!
//! Records wait in a ring. When it is full, one backward pass over all of it finishes the oldest
//! block, so that each finished cell has been seen at least [`LAG_CELLS`] cells ahead and the
//! pass costs (lag + block) / block steps a cell.

use crate::cell::Cell;
use crate::filter::{Backward, Record};
use crate::scalar::Scalar;
use heapless::Deque;

/// Cells that a finished cell has been seen ahead of, at the least: 110 m.
pub const LAG_CELLS: usize = 44;
/// Cells finished at once.
pub const BLOCK_CELLS: usize = 20;
/// Cells in the ring.
const RING_CELLS: usize = LAG_CELLS + BLOCK_CELLS;

/// The ring, and the finished cells that nobody has fetched.
#[derive(Clone, Debug)]
pub struct Lag<S> {
    records: Deque<Record<S>, RING_CELLS>,
    finished: Deque<Cell, BLOCK_CELLS>,
}

impl<S: Scalar> Lag<S> {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            records: Deque::new(),
            finished: Deque::new(),
        }
    }

    /// Takes the newest record; returns how many finished cells were overwritten because nobody
    /// fetched them.
    pub fn push(&mut self, record: Record<S>) -> usize {
        let mut lost = 0;
        if self.records.is_full() {
            lost = self.finish(BLOCK_CELLS);
        }
        // There is room: finish() took a block out.
        let _ = self.records.push_back(record);
        lost
    }

    /// The next finished cell.
    pub fn next_cell(&mut self) -> Option<Cell> {
        self.finished.pop_front()
    }

    /// The next cell at the end of a drive, finished with what lag there is.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        if self.finished.is_empty() {
            self.finish(BLOCK_CELLS.min(self.records.len()));
        }
        self.finished.pop_front()
    }

    /// One backward pass; moves the oldest `count` records to the finished cells.
    fn finish(&mut self, count: usize) -> usize {
        let lost = self.finished.len();
        self.finished.clear();
        let mut backward = Backward::new();
        for (from_oldest, record) in self.records.iter().enumerate().rev() {
            let filtered = backward.absorb(record);
            if from_oldest < count {
                let cell = Cell {
                    place: record.place,
                    live: filtered.estimate(),
                    lagged: backward.estimate(record),
                };
                // At most a block, and the queue was emptied.
                let _ = self.finished.push_front(cell);
            }
            backward.retreat(record);
        }
        for _ in 0..count {
            self.records.pop_front();
        }
        lost
    }
}

impl<S: Scalar> Default for Lag<S> {
    fn default() -> Self {
        Self::new()
    }
}
