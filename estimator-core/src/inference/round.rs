//! One round: the filter forward over a stretch of cells, and back, inferring the variances.
//!
//! A round is long. It is therefore done in shares of some cells, and what it gathers on its way is a
//! [`Pass`]. The states before blocks of cells are stored on the way forward; on the way back, each
//! block is filtered again from there.

use super::cell_model::{CellModel, CellTerms};
use super::fixed_point::{FixedPoint, PassedCell};
use super::levels::{LevelSums, Levels};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use crate::filter::{Adjoint, CellInput, Record, State};
use crate::scalar::Scalar;

/// Cells with their variances. The first cell begins a segment; all parts cover the same cells.
#[derive(Debug)]
pub struct Stretch<'a> {
    /// The cells.
    pub cells: &'a [CellInput],
    /// Variances of each cell.
    pub own: &'a mut [CellVariances],
    /// Variances of each segment.
    pub segments: &'a mut [SegmentVariances],
}

/// What a round needs besides its stretch.
#[derive(Clone, Debug)]
pub struct Round<'n> {
    /// F and noises of cells.
    pub model: CellModel<'n>,
    /// Levels of the noises.
    pub levels: Levels,
    /// Whether the variances are inferred. Without, they stay.
    pub infers: bool,
    /// Number of the first cells that leave after the round: their sums are kept apart.
    pub leaving: usize,
}

/// Memory of a round.
#[derive(Debug)]
pub struct Memory<'a, S> {
    /// State before each block of cells. The last block needs none.
    pub checkpoints: &'a mut [State<S>],
    /// Records of the cells of one block.
    pub records: &'a mut [Record<S>],
}

/// A round on its way.
#[derive(Clone, Debug)]
pub struct Pass<S> {
    /// Scores of closed steps, and the sums of the cells that stay.
    pub found: FixedPoint,
    /// Sums of the cells that leave.
    pub leaving: LevelSums,
    /// The state behind the last cell, once the way forward is done.
    pub newest: State<S>,
    stage: Stage,
    /// The next cell forward; on the way back, the one before it is the next.
    at: usize,
    state: State<S>,
    adjoint: Adjoint<S>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Forward,
    /// Forward again over the block that begins at this cell.
    Again(usize),
    /// Back over it.
    Back(usize),
    Done,
}

impl<S: Scalar> Pass<S> {
    /// Nothing to do.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn done() -> Self {
        Self {
            stage: Stage::Done,
            ..Self::from(State::ZERO)
        }
    }

    /// Begins a round over a stretch before which the filter was at `start`.
    #[must_use]
    #[inline(always)] // As done().
    pub fn from(start: State<S>) -> Self {
        Self {
            found: FixedPoint::default(),
            leaving: LevelSums::NONE,
            newest: start,
            stage: Stage::Forward,
            at: 0,
            state: start,
            adjoint: Adjoint::NONE,
        }
    }

    /// Returns what the cells say of the state before them, once the way back is done.
    #[must_use]
    pub const fn adjoint(&self) -> &Adjoint<S> {
        &self.adjoint
    }

    /// Returns whether nothing is left to do.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    /// Goes over at most so many cells. `take` gets each cell's index, record, and what later cells
    /// say, from the last cell to the first.
    pub fn advance(
        &mut self,
        round: &Round<'_>,
        stretch: &mut Stretch<'_>,
        memory: &mut Memory<'_, S>,
        cells: usize,
        take: impl FnMut(usize, &Record<S>, &Adjoint<S>),
    ) {
        match self.stage {
            Stage::Forward => self.forward(round, stretch, memory, cells),
            Stage::Again(first) => self.again(round, stretch, memory, first, cells),
            Stage::Back(first) => self.back(round, stretch, memory, first, cells, take),
            Stage::Done => {}
        }
    }

    fn forward(
        &mut self,
        round: &Round<'_>,
        stretch: &Stretch<'_>,
        memory: &mut Memory<'_, S>,
        cells: usize,
    ) {
        let block = memory.records.len().max(1);
        let end = stretch.cells.len().min(self.at + cells);
        while self.at < end {
            let within = self.at % block;
            if within == 0
                && let Some(checkpoint) = memory.checkpoints.get_mut(self.at / block)
            {
                *checkpoint = self.state;
            }
            self.step(round, stretch, memory, within);
        }
        if end == stretch.cells.len() {
            self.newest = self.state;
            // The records of the last block are those that are left.
            self.stage = match end.checked_sub(1) {
                Some(last) => Stage::Back(last / block * block),
                None => Stage::Done,
            };
        }
    }

    fn again(
        &mut self,
        round: &Round<'_>,
        stretch: &Stretch<'_>,
        memory: &mut Memory<'_, S>,
        first: usize,
        cells: usize,
    ) {
        let last = first + memory.records.len();
        let end = last.min(self.at + cells);
        while self.at < end {
            self.step(round, stretch, memory, self.at - first);
        }
        if end == last {
            self.stage = Stage::Back(first);
        }
    }

    fn step(
        &mut self,
        round: &Round<'_>,
        stretch: &Stretch<'_>,
        memory: &mut Memory<'_, S>,
        within: usize,
    ) {
        if let (Some((cell, terms)), Some(record)) = (
            round.terms(stretch, self.at),
            memory.records.get_mut(within),
        ) {
            round.step(&mut self.state, cell, &terms, None, record);
        }
        self.at += 1;
    }

    fn back(
        &mut self,
        round: &Round<'_>,
        stretch: &mut Stretch<'_>,
        memory: &mut Memory<'_, S>,
        first: usize,
        cells: usize,
        mut take: impl FnMut(usize, &Record<S>, &Adjoint<S>),
    ) {
        let end = first.max(self.at.saturating_sub(cells));
        while self.at > end {
            self.at -= 1;
            let Some(record) = memory.records.get(self.at - first) else {
                continue;
            };
            take(self.at, record, &self.adjoint);
            if self.at + 1 == round.leaving {
                self.leaving = core::mem::take(&mut self.found.sums);
            }
            self.retreat(round, stretch, record);
        }
        if end > first {
            return;
        }
        let block = memory.records.len().max(1);
        self.stage = match first.checked_sub(block) {
            Some(before) => {
                if let Some(checkpoint) = memory.checkpoints.get(before / block) {
                    self.state = *checkpoint;
                }
                self.at = before;
                Stage::Again(before)
            }
            None => {
                if round.leaving > 0 {
                    // The cells that stay came first.
                    core::mem::swap(&mut self.leaving, &mut self.found.sums);
                }
                Stage::Done
            }
        };
    }

    /// Goes back over the cell of a record.
    #[inline(always)]
    fn retreat(&mut self, round: &Round<'_>, stretch: &mut Stretch<'_>, record: &Record<S>) {
        let index = self.at;
        let Some((cell, terms)) = round.terms(stretch, index) else {
            return;
        };
        let found = self.adjoint.retreat(cell, &terms.dynamics, record);
        let segment_number = index / SEGMENT_CELLS;
        let own = stretch.own.get_mut(index);
        let segment = stretch.segments.get_mut(segment_number);
        if let (true, Some(own), Some(segment)) = (round.infers, own, segment) {
            let mut passed = PassedCell {
                cell,
                own,
                segment,
                segment_number,
                begins_segment: index.is_multiple_of(SEGMENT_CELLS),
                terms: &terms,
                found: &found,
            };
            self.found
                .infer(round.model.numbers, &round.levels, &mut passed);
        }
    }
}

impl Round<'_> {
    /// Moves a state over a cell of the stretch, and leaves its record.
    #[inline(never)] // One copy: flash is small.
    pub fn step<S: Scalar>(
        &self,
        state: &mut State<S>,
        cell: &CellInput,
        terms: &CellTerms<S>,
        gate: Option<S>,
        record: &mut Record<S>,
    ) {
        if cell.marks.gap {
            let numbers = self.model.numbers;
            let road_level = self.levels.road;
            state.start(numbers, cell, &terms.noise, road_level, gate, record);
        } else {
            state.step(cell, &terms.dynamics, &terms.noise, gate, record);
        }
    }

    /// Runs over a stretch before which the filter was at `start`, all at once.
    pub fn run<S: Scalar>(
        &self,
        start: &State<S>,
        stretch: &mut Stretch<'_>,
        memory: &mut Memory<'_, S>,
        mut take: impl FnMut(usize, &Record<S>, &Adjoint<S>),
    ) -> Pass<S> {
        let mut pass = Pass::from(*start);
        while !pass.is_done() {
            pass.advance(self, stretch, memory, usize::MAX / 2, &mut take);
        }
        pass
    }

    /// Returns a cell with its terms.
    #[inline(never)] // One copy: flash is small.
    #[must_use]
    pub fn terms<'c, S: Scalar>(
        &self,
        stretch: &Stretch<'c>,
        index: usize,
    ) -> Option<(&'c CellInput, CellTerms<S>)> {
        let cell = stretch.cells.get(index)?;
        let own = stretch.own.get(index)?;
        let segment = stretch.segments.get(index / SEGMENT_CELLS)?;
        let begins = index.is_multiple_of(SEGMENT_CELLS);
        Some((
            cell,
            self.model.terms(cell, own, segment, begins, &self.levels),
        ))
    }
}
