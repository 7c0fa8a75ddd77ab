//! Fixed-lag smoothing in fixed memory. It goes back over each step once.
//!
//! When a block of steps is full, one backward pass over it smooths its cells by the rest of the
//! block, and leaves its [`BlockSmoother`]: what it says of anything before it. A cell is finished
//! [`LAG_CELLS`] later, by going back over the block smoothers since. The result is that of a pass
//! over all steps of the lag, with a tenth of the work and a third of the memory.
//!
//! This file has the queues of cells and blocks. The recursion over one step is in
//! [`backward_pass`](super::backward_pass), the one over a block in
//! [`block_smoother`](super::block_smoother).

use super::backward_pass::BackwardPass;
use super::block_smoother::BlockSmoother;
use crate::cell::{Cell, CellEnd, Uncertain};
use crate::filter::{Quantity, QuantityEstimate, SmootherInput, State, StepRecord};
use crate::scalar::Scalar;
use heapless::{Deque, Vec};

/// Number of cells in a block.
pub const BLOCK_CELLS: usize = 20;
/// Number of blocks after its own that a finished cell is smoothed by.
const LAG_BLOCKS: usize = 10;
/// Smallest number of later cells that a finished cell is smoothed by: 500 m.
pub const LAG_CELLS: usize = LAG_BLOCKS * BLOCK_CELLS;
/// Number of blocks in memory: one more, which is being finished.
const BLOCKS: usize = LAG_BLOCKS + 1;

/// Returns the memory that a lag of this many blocks takes, bytes.
#[must_use]
pub const fn bytes<S>(lag_blocks: usize) -> usize {
    let filling = BLOCK_CELLS * size_of::<FilteredCell<S>>();
    let finished = BLOCK_CELLS * size_of::<Cell>();
    let block = size_of::<Block<S>>() + BLOCK_CELLS * size_of::<PendingCell<S>>();
    filling + (lag_blocks + 1) * block + finished
}

/// A cell of the block that is being filled.
#[derive(Clone, Copy, Debug)]
struct FilteredCell<S> {
    end: CellEnd,
    smoother_input: SmootherInput<S>,
    slope: QuantityEstimate<S>,
    altitude: QuantityEstimate<S>,
    origin_m: Option<f32>,
    consistent: bool,
}

/// A cell that was smoothed by its block and waits for later blocks.
#[derive(Clone, Copy, Debug)]
struct PendingCell<S> {
    end: CellEnd,
    live_grade_percent: Uncertain,
    altitude_m: Option<Uncertain>,
    /// Its covariance is with the states at the end of the block.
    slope: QuantityEstimate<S>,
    live_consistent: bool,
    lagged_consistent: bool,
}

/// A full block, and the number of its cells.
#[derive(Clone, Debug)]
struct Block<S> {
    smoother: BlockSmoother<S>,
    cells: usize,
}

/// A fixed-lag smoother: the blocks of the lag, and the finished cells that wait to be fetched.
#[derive(Clone, Debug)]
pub struct FixedLag<S> {
    filtered: Vec<FilteredCell<S>, BLOCK_CELLS>,
    blocks: Deque<Block<S>, BLOCKS>,
    /// The cells of these blocks, the oldest block first, but within each block the last cell first.
    pending: Deque<PendingCell<S>, { BLOCKS * BLOCK_CELLS }>,
    finished: Deque<Cell, BLOCK_CELLS>,
    /// First cell of the newest disagreement that pending cells are not marked with.
    disagreeing_since: Option<u32>,
}

impl<S: Scalar> FixedLag<S> {
    /// Creates an empty smoother.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            filtered: Vec::new(),
            blocks: Deque::new(),
            pending: Deque::new(),
            finished: Deque::new(),
            disagreeing_since: None,
        }
    }

    /// Takes the newest step and the state after it. Returns the number of finished cells that were
    /// overwritten because they were not fetched.
    pub fn push(&mut self, step: &StepRecord<S>, state: &State<S>) -> usize {
        // There is room: close_block() empties a full block.
        let _ = self.filtered.push(FilteredCell {
            end: step.end,
            smoother_input: step.smoother_input,
            slope: state.quantity(Quantity::Slope),
            altitude: state.quantity(Quantity::Altitude),
            origin_m: state.origin_m,
            consistent: step.disagreement.is_none(),
        });
        if !step.disagreement.is_none() {
            let since = (step.end.cell + 1).saturating_sub(step.disagreeing_cells);
            let before = self.disagreeing_since.unwrap_or(since);
            self.disagreeing_since = Some(before.min(since));
        }
        if !self.filtered.is_full() {
            return 0;
        }
        self.close_block();
        if self.blocks.is_full() {
            self.finish()
        } else {
            0
        }
    }

    /// Returns the next finished cell.
    pub fn next_cell(&mut self) -> Option<Cell> {
        self.finished.pop_front()
    }

    /// Returns the next cell at the end of a drive, smoothed by what follows it.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        if !self.filtered.is_empty() {
            self.close_block();
        }
        if self.finished.is_empty() {
            self.finish();
        }
        self.finished.pop_front()
    }

    /// Appends an empty block. It is filled in the queue: on the stack it would be the largest
    /// object of all.
    #[inline(never)] // Its copy of the block is gone from the stack before the block is filled.
    fn open_block(&mut self) {
        let block = Block {
            smoother: BlockSmoother::new(),
            cells: self.filtered.len(),
        };
        // There is room: finish() keeps that of one block free.
        if self.blocks.push_back(block).is_err() {
            self.filtered.clear();
        }
    }

    /// Makes a block of the steps since the last one.
    #[inline(never)] // So that its stack and that of finish() are not in use at once.
    fn close_block(&mut self) {
        self.open_block();
        let Some(Block { smoother, .. }) = self.blocks.back_mut() else {
            return;
        };
        let disagreeing_since = self.disagreeing_since.take().unwrap_or(u32::MAX);
        for cell in &mut self.pending {
            cell.lagged_consistent &= cell.end.cell < disagreeing_since;
        }
        while let Some(cell) = self.filtered.pop() {
            // There is room, as for the block.
            let _ = self.pending.push_back(PendingCell {
                // Field by field: a copy as a whole needs memmove, a kilobyte of flash.
                end: CellEnd { ..cell.end },
                live_grade_percent: cell.slope.grade(),
                altitude_m: smoother
                    .within()
                    .smooth(&cell.altitude)
                    .altitude(cell.origin_m),
                slope: smoother.smooth(&cell.slope),
                live_consistent: cell.consistent,
                lagged_consistent: cell.consistent && cell.end.cell < disagreeing_since,
            });
            smoother.retreat(&cell.smoother_input);
        }
    }

    /// Finishes the oldest block. Returns the number of finished cells that it overwrites.
    #[inline(never)] // As close_block().
    fn finish(&mut self) -> usize {
        let mut pass = BackwardPass::new();
        for later in self.blocks.iter().skip(1).rev() {
            later.smoother.retreat_through(&mut pass);
        }
        let Some(block) = self.blocks.pop_front() else {
            return 0;
        };
        let lost = self.finished.len();
        self.finished.clear();
        for _ in 0..block.cells {
            let Some(cell) = self.pending.pop_front() else {
                break;
            };
            // There is room: at most a block, and the queue is empty.
            let _ = self.finished.push_front(Cell {
                end: cell.end,
                live_grade_percent: cell.live_grade_percent,
                lagged_grade_percent: pass.smooth(&cell.slope).grade(),
                altitude_m: cell.altitude_m,
                live_consistent: cell.live_consistent,
                lagged_consistent: cell.lagged_consistent,
            });
        }
        lost
    }
}

impl<S: Scalar> Default for FixedLag<S> {
    fn default() -> Self {
        Self::new()
    }
}
