//! Fixed-lag smoothing in fixed memory, each step gone back over once.
//!
//! When a block of steps is full, one pass back over it corrects its cells by what the rest of the
//! block says, and leaves the block's [`Passage`]: what it says of anything before it. A cell is
//! finished [`LAG_CELLS`] later by going back over the passages of the blocks since. The result is
//! that of a pass over all steps of the lag, for a tenth of the work and a third of the memory.

use crate::cell::{Cell, Place, Uncertain};
use crate::filter::{Backward, Look, Moved, Passage, Quantity, State, Trace};
use crate::scalar::Scalar;
use heapless::{Deque, Vec};

/// Cells in a block.
pub const BLOCK_CELLS: usize = 20;
/// Blocks that a finished cell has been seen ahead of its own.
const LAG_BLOCKS: usize = 10;
/// Cells that a finished cell has been seen ahead of, at the least: 500 m.
pub const LAG_CELLS: usize = LAG_BLOCKS * BLOCK_CELLS;
/// Blocks in memory: one more, which is being finished.
const BLOCKS: usize = LAG_BLOCKS + 1;

/// Memory that a lag of this many blocks takes, bytes.
#[must_use]
pub const fn bytes<S>(lag_blocks: usize) -> usize {
    let filling = BLOCK_CELLS * size_of::<Passed<S>>();
    let finished = BLOCK_CELLS * size_of::<Cell>();
    let block = size_of::<Block<S>>() + BLOCK_CELLS * size_of::<Waiting<S>>();
    filling + (lag_blocks + 1) * block + finished
}

/// A step of the block being filled.
#[derive(Clone, Copy, Debug)]
struct Passed<S> {
    place: Place,
    trace: Trace<S>,
    slope: Look<S>,
    altitude: Look<S>,
    origin_m: Option<f32>,
}

/// A cell that waits for what comes after its block.
#[derive(Clone, Copy, Debug)]
struct Waiting<S> {
    place: Place,
    live_grade_percent: Uncertain,
    altitude_m: Option<Uncertain>,
    /// As it hangs on the states at the end of the block.
    slope: Look<S>,
}

/// A full block: the way back over it, and the number of its cells.
#[derive(Clone, Debug)]
struct Block<S> {
    passage: Passage<S>,
    cells: usize,
}

/// The blocks, and the finished cells that nobody has fetched.
#[derive(Clone, Debug)]
pub struct Lag<S> {
    passed: Vec<Passed<S>, BLOCK_CELLS>,
    blocks: Deque<Block<S>, BLOCKS>,
    /// Their cells: the oldest block's first, but of each block the last one first.
    waiting: Deque<Waiting<S>, { BLOCKS * BLOCK_CELLS }>,
    finished: Deque<Cell, BLOCK_CELLS>,
}

impl<S: Scalar> Lag<S> {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            passed: Vec::new(),
            blocks: Deque::new(),
            waiting: Deque::new(),
            finished: Deque::new(),
        }
    }

    /// Takes the newest step and the state to which it led; returns how many finished cells were
    /// overwritten because nobody fetched them.
    pub fn push(&mut self, moved: &Moved<S>, state: &State<S>) -> usize {
        // There is room: close_block() empties a full one.
        let _ = self.passed.push(Passed {
            place: moved.place,
            trace: moved.trace,
            slope: state.look(Quantity::Slope),
            altitude: state.look(Quantity::Altitude),
            origin_m: state.origin_m,
        });
        if !self.passed.is_full() {
            return 0;
        }
        self.close_block();
        if self.blocks.is_full() {
            self.finish()
        } else {
            0
        }
    }

    /// The next finished cell.
    pub fn next_cell(&mut self) -> Option<Cell> {
        self.finished.pop_front()
    }

    /// The next cell at the end of a drive, finished with what lag there is.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        if !self.passed.is_empty() {
            self.close_block();
        }
        if self.finished.is_empty() {
            self.finish();
        }
        self.finished.pop_front()
    }

    /// Goes back over the steps since the last block, which make one.
    fn close_block(&mut self) {
        let mut passage = Passage::new();
        let cells = self.passed.len();
        while let Some(passed) = self.passed.pop() {
            // finish() keeps a block's place free.
            let _ = self.waiting.push_back(Waiting {
                // Field by field: as a whole it takes memmove, a kilobyte of flash.
                place: Place { ..passed.place },
                live_grade_percent: passed.slope.grade(),
                altitude_m: passage
                    .backward()
                    .correct(&passed.altitude)
                    .altitude(passed.origin_m),
                slope: passage.correct(&passed.slope),
            });
            passage.retreat(&passed.trace);
        }
        let _ = self.blocks.push_back(Block { passage, cells });
    }

    /// Finishes the oldest block; returns how many finished cells it overwrites.
    fn finish(&mut self) -> usize {
        let mut backward = Backward::new();
        for later in self.blocks.iter().skip(1).rev() {
            backward.retreat_through(&later.passage);
        }
        let Some(block) = self.blocks.pop_front() else {
            return 0;
        };
        let lost = self.finished.len();
        self.finished.clear();
        for _ in 0..block.cells {
            let Some(waiting) = self.waiting.pop_front() else {
                break;
            };
            // At most a block, and the queue was emptied.
            let _ = self.finished.push_front(Cell {
                place: waiting.place,
                live_grade_percent: waiting.live_grade_percent,
                lagged_grade_percent: backward.correct(&waiting.slope).grade(),
                altitude_m: waiting.altitude_m,
            });
        }
        lost
    }
}

impl<S: Scalar> Default for Lag<S> {
    fn default() -> Self {
        Self::new()
    }
}
