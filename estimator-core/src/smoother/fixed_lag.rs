//! Fixed-lag smoothing in fixed memory and in small shares of work. It goes back over each step
//! once.
//!
//! When a block of steps is full, one backward pass over it smooths its cells by the rest of the
//! block, and leaves its [`BlockSmoother`]: what it says of anything before it. A cell is finished
//! [`LAG_CELLS`] later, by going back over the block smoothers since. The result is that of a pass
//! over all steps of the lag, with a tenth of the work and a third of the memory.
//!
//! The work that a full block asks for is as much as that of twenty steps of the filter. It is
//! spread over the following cells, and done before the next block is full (`Stage`).
//!
//! This file has the queues of cells and blocks. The recursion over one step is in
//! [`backward_pass`](super::backward_pass), the one over a block in
//! [`block_smoother`](super::block_smoother).

use super::backward_pass::BackwardPass;
use super::block_smoother::BlockSmoother;
use super::lagged_cell::{FilteredCell, FinishedCell, PendingCell, WithinBlock};
use super::two_stacks::TwoStacks;
use crate::cell::Cell;
use crate::filter::{Quantity, State, StepRecord};
use crate::scalar::Scalar;
use heapless::Deque;

/// Number of cells in a block.
pub const BLOCK_CELLS: usize = 20;
/// Number of blocks after its own that a finished cell is smoothed by.
const LAG_BLOCKS: usize = 10;
/// Smallest number of later cells that a finished cell is smoothed by: 500 m.
pub const LAG_CELLS: usize = LAG_BLOCKS * BLOCK_CELLS;
/// Number of blocks in memory: one more, which is being finished.
const BLOCKS: usize = LAG_BLOCKS + 1;

/// Number of cells that one share of work goes back over.
const CELLS_A_SHARE: usize = 2;
/// Number of blocks that one share of work goes back over.
const BLOCKS_A_SHARE: usize = 2;
/// Number of cells that one share of work finishes.
const FINISHED_A_SHARE: usize = 10;
/// Number of cells from the end of a block until the cells that it finishes can be fetched.
pub const SHARES: usize = BLOCK_CELLS.div_ceil(CELLS_A_SHARE)
    + LAG_BLOCKS.div_ceil(BLOCKS_A_SHARE)
    + BLOCK_CELLS.div_ceil(FINISHED_A_SHARE);
const _: () = assert!(
    SHARES <= BLOCK_CELLS,
    "a block is done before the next one is full"
);

/// Returns the memory that a lag of this many blocks takes, bytes.
#[must_use]
pub const fn bytes<S>(lag_blocks: usize) -> usize {
    let filling = BLOCK_CELLS * size_of::<FilteredCell<S>>();
    let finished = BLOCK_CELLS * size_of::<FinishedCell>();
    let block = size_of::<Block<S>>() + BLOCK_CELLS * size_of::<PendingCell<S>>();
    filling + (lag_blocks + 1) * block + finished
}

/// A block that is closed, or being closed.
#[derive(Clone, Debug)]
struct Block<S> {
    smoother: BlockSmoother<S>,
    /// Number of its cells that the smoother has gone back over.
    cells: usize,
    /// First cell of a disagreement that was noticed in the block.
    disagreeing_since: u32,
    /// Largest variance of a doubt in the block, %².
    doubt_variance: f32,
}

/// What the next share of work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Going back over the cells of the newest block, if any are left.
    Close,
    /// Going back over the blocks after the oldest one. This many are left.
    Retreat(usize),
    /// Finishing the cells of the oldest block, the last one first.
    Finish,
}

/// A fixed-lag smoother: the blocks of the lag, and the finished cells that wait to be fetched.
#[derive(Clone, Debug)]
pub struct FixedLag<S> {
    /// The steps of the block that is filled, and those of the one that is being closed.
    filtered: TwoStacks<FilteredCell<S>, BLOCK_CELLS>,
    blocks: Deque<Block<S>, BLOCKS>,
    /// The cells of these blocks, the oldest block first, but within each block the last cell first.
    pending: Deque<PendingCell<S>, { BLOCKS * BLOCK_CELLS }>,
    finished: Deque<FinishedCell, BLOCK_CELLS>,
    stage: Stage,
    /// The pass over the blocks after the oldest one.
    pass: BackwardPass<S>,
    /// First cell of a disagreement that was noticed in one of the blocks of this pass.
    disagreeing_in_pass: u32,
    /// First cell of the newest disagreement that no block knows.
    disagreeing_since: Option<u32>,
    /// Largest variance of a doubt that no block knows, and in one of the blocks of this pass, %².
    doubt_variance: f32,
    doubt_variance_in_pass: f32,
}

impl<S: Scalar> FixedLag<S> {
    /// Creates an empty smoother.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            filtered: TwoStacks::new(),
            blocks: Deque::new(),
            pending: Deque::new(),
            finished: Deque::new(),
            stage: Stage::Close,
            pass: BackwardPass::new(),
            disagreeing_in_pass: u32::MAX,
            disagreeing_since: None,
            doubt_variance: 0.0,
            doubt_variance_in_pass: 0.0,
        }
    }

    /// Does a share of work, and takes the newest step and the state after it. Returns the number of
    /// finished cells that were overwritten because they were not fetched.
    pub fn push(&mut self, step: &StepRecord<S>, state: &State<S>) -> usize {
        let lost = self.work();
        // There is room: a block is closed faster than the next one is filled.
        self.filtered.push(FilteredCell {
            end: step.end,
            smoother_input: step.smoother_input,
            slope: state.quantity(Quantity::Slope),
            altitude: state.quantity(Quantity::Altitude),
            origin_m: state.origin_m,
            doubt_variance: state.doubt_variance,
            consistent: step.is_undone || step.disagreement.is_none(),
        });
        self.doubt_variance = self.doubt_variance.max(state.doubt_variance);
        if !step.disagreement.is_none() {
            let since = (step.end.cell + 1).saturating_sub(step.disagreeing_cells);
            let before = self.disagreeing_since.unwrap_or(since);
            self.disagreeing_since = Some(before.min(since));
        }
        if self.filtered.filled() == BLOCK_CELLS {
            self.open_block();
        }
        lost
    }

    /// Returns the next finished cell.
    pub fn next_cell(&mut self) -> Option<Cell> {
        // The first cell of a block is finished last.
        if self.stage == Stage::Finish {
            return None;
        }
        self.finished.pop_front().map(|cell| cell.unpack())
    }

    /// Does a share of the work at the end of a drive, after which all cells are finished, smoothed
    /// by what follows them. Returns the number of finished cells that were overwritten because they
    /// were not fetched after the share before; `None` when nothing is left to do.
    pub fn drain_step(&mut self) -> Option<usize> {
        if self.is_idle() {
            if self.filtered.filled() > 0 {
                self.open_block();
            } else if self.blocks.is_empty() {
                return None;
            } else {
                self.start_finishing();
            }
        }
        Some(self.work())
    }

    /// Returns the next cell at the end of a drive, smoothed by what follows it. Its work is not
    /// bounded by that of a share.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        loop {
            let cell = self.next_cell();
            if cell.is_some() || self.drain_step().is_none() {
                return cell;
            }
        }
    }

    fn is_idle(&self) -> bool {
        self.stage == Stage::Close && self.filtered.left() == 0
    }

    /// Does one share of the work. Returns the number of finished cells that it overwrites.
    fn work(&mut self) -> usize {
        match self.stage {
            Stage::Close => self.close(),
            Stage::Retreat(left) => return self.retreat(left),
            Stage::Finish => self.finish(),
        }
        0
    }

    /// Appends an empty block. It is filled in the queue: on the stack it would be the largest
    /// object of all.
    #[inline(never)] // Its copy of the block is gone from the stack before the block is filled.
    fn open_block(&mut self) {
        let block = Block {
            smoother: BlockSmoother::new(),
            cells: 0,
            disagreeing_since: self.disagreeing_since.take().unwrap_or(u32::MAX),
            doubt_variance: core::mem::take(&mut self.doubt_variance),
        };
        // There is room: finish() has removed the oldest block.
        let _ = self.blocks.push_back(block);
        self.filtered.turn();
    }

    /// Goes back over some more cells of the newest block.
    #[inline(never)] // So that its stack and those of the other stages are not in use at once.
    fn close(&mut self) {
        let Some(block) = self.blocks.back_mut() else {
            return;
        };
        for _ in 0..CELLS_A_SHARE {
            let Some(cell) = self.filtered.last() else {
                break;
            };
            let smoother = &mut block.smoother;
            let altitude = smoother.within().smooth(&cell.altitude);
            let within = WithinBlock {
                slope: smoother.smooth(&cell.slope),
                altitude_m: altitude.altitude(cell.origin_m),
                consistent: cell.consistent && cell.end.cell < block.disagreeing_since,
            };
            // There is room, as for the block.
            let _ = self.pending.push_back(PendingCell::new(cell, &within));
            smoother.retreat(&cell.smoother_input);
            block.cells += 1;
            self.filtered.drop_last();
        }
        if self.filtered.left() == 0 && self.blocks.is_full() {
            self.start_finishing();
        }
    }

    fn start_finishing(&mut self) {
        self.pass = BackwardPass::new();
        self.disagreeing_in_pass = u32::MAX;
        self.doubt_variance_in_pass = 0.0;
        self.stage = Stage::Retreat(self.blocks.len().saturating_sub(1));
    }

    /// Goes back over some more blocks after the oldest one. Returns the number of finished cells that
    /// the oldest one overwrites.
    #[inline(never)] // As close().
    fn retreat(&mut self, left: usize) -> usize {
        let next = left.saturating_sub(BLOCKS_A_SHARE);
        for later in (next + 1..=left).rev() {
            if let Some(block) = self.blocks.get(later) {
                block.smoother.retreat_through(&mut self.pass);
                let since = block.disagreeing_since;
                self.disagreeing_in_pass = self.disagreeing_in_pass.min(since);
                self.doubt_variance_in_pass = self.doubt_variance_in_pass.max(block.doubt_variance);
            }
        }
        self.stage = Stage::Retreat(next);
        if next > 0 {
            return 0;
        }
        self.stage = Stage::Finish;
        let lost = self.finished.len();
        self.finished.clear();
        lost
    }

    /// Finishes some more cells of the oldest block.
    #[inline(never)] // As close().
    fn finish(&mut self) {
        let Some(oldest) = self.blocks.front_mut() else {
            return;
        };
        let cells = FINISHED_A_SHARE.min(oldest.cells);
        oldest.cells -= cells;
        let doubt_variance = oldest.doubt_variance.max(self.doubt_variance_in_pass);
        for _ in 0..cells {
            let Some(cell) = self.pending.pop_front() else {
                break;
            };
            let grade = self.pass.smooth(cell.slope()).grade();
            let grade = grade.widened(doubt_variance);
            // There is room: at most a block, and the queue was empty.
            let _ = self
                .finished
                .push_front(cell.finish(grade, self.disagreeing_in_pass));
        }
        if oldest.cells == 0 {
            self.blocks.pop_front();
            self.stage = Stage::Close;
        }
    }
}

impl<S: Scalar> Default for FixedLag<S> {
    fn default() -> Self {
        Self::new()
    }
}
