//! One round: the filter forward over a stretch of cells, and back, inferring the variances.

use super::cell_model::{CellModel, CellTerms};
use super::fixed_point::{FixedPoint, PassedCell};
use super::levels::{LevelSums, Levels};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use crate::robust::{Adjoint, CellInput, Record, State};
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
}

/// Memory of a round. There must be a record for each checkpoint's cells: together they hold at least
/// as many cells as the stretch has.
#[derive(Debug)]
pub struct Memory<'a, S> {
    /// State before each block of cells.
    pub checkpoints: &'a mut [State<S>],
    /// Records of the cells of one block.
    pub records: &'a mut [Record<S>],
}

/// What a round found.
#[derive(Debug)]
pub struct Found<S> {
    /// The state behind the last cell.
    pub newest: State<S>,
    /// Scores of closed steps, and sums of the cells that stay.
    pub fixed_point: FixedPoint,
    /// Sums of the cells before those that stay.
    pub leaving: LevelSums,
}

impl Round<'_> {
    /// Moves a state over a cell of the stretch.
    #[inline(always)]
    pub fn step<S: Scalar>(
        &self,
        state: &mut State<S>,
        cell: &CellInput,
        terms: &CellTerms<S>,
        gate: Option<S>,
    ) -> Record<S> {
        if cell.marks.gap {
            let numbers = self.model.numbers;
            state.start(numbers, cell, &terms.noise, self.levels.road, gate)
        } else {
            state.step(cell, &terms.dynamics, &terms.noise, gate)
        }
    }

    /// Runs over a stretch before which the filter was at `start`. Cells before `stay` leave after this
    /// round. `take` gets each cell's index, record, and what later cells say, from the last cell to the
    /// first. Without `infers` the variances stay.
    pub fn run<S: Scalar>(
        &self,
        start: &State<S>,
        stretch: &mut Stretch<'_>,
        memory: &mut Memory<'_, S>,
        stay: usize,
        infers: bool,
        mut take: impl FnMut(usize, &Record<S>, &Adjoint<S>),
    ) -> Found<S> {
        let block = memory.records.len().max(1);
        let mut state = *start;
        let (checkpoints, records) = (&mut *memory.checkpoints, &mut *memory.records);
        for (number, checkpoint) in checkpoints.iter_mut().enumerate() {
            *checkpoint = state;
            self.forward(&mut state, stretch, number * block, records);
        }
        let mut found = Found {
            newest: state,
            fixed_point: FixedPoint::default(),
            leaving: LevelSums::default(),
        };
        let mut adjoint = Adjoint::NONE;
        let blocks = stretch.cells.len().div_ceil(block);
        for (number, checkpoint) in checkpoints.iter().enumerate().take(blocks).rev() {
            let first = number * block;
            if number + 1 < blocks {
                let mut state = *checkpoint;
                self.forward(&mut state, stretch, first, records);
            }
            let cells = stretch.cells.len().saturating_sub(first).min(block);
            for (within, record) in records.iter().enumerate().take(cells).rev() {
                let index = first + within;
                take(index, record, &adjoint);
                if index + 1 == stay {
                    let staying = core::mem::take(&mut found.fixed_point.sums);
                    found.leaving = staying;
                }
                self.retreat(
                    &mut adjoint,
                    stretch,
                    index,
                    record,
                    infers,
                    &mut found.fixed_point,
                );
            }
        }
        // The sums were gathered from the last cell on: those of the cells that stay came first.
        if stay > 0 && stay <= stretch.cells.len() {
            core::mem::swap(&mut found.leaving, &mut found.fixed_point.sums);
        }
        found
    }

    /// Moves a state over the block from `first` on.
    fn forward<S: Scalar>(
        &self,
        state: &mut State<S>,
        stretch: &Stretch<'_>,
        first: usize,
        records: &mut [Record<S>],
    ) {
        for (record, index) in records.iter_mut().zip(first..stretch.cells.len()) {
            if let Some((cell, terms)) = self.terms(stretch, index) {
                *record = self.step(state, cell, &terms, None);
            }
        }
    }

    /// Returns a cell with its terms.
    #[inline(always)]
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

    /// Goes back over a cell.
    #[inline(always)]
    fn retreat<S: Scalar>(
        &self,
        adjoint: &mut Adjoint<S>,
        stretch: &mut Stretch<'_>,
        index: usize,
        record: &Record<S>,
        infers: bool,
        fixed_point: &mut FixedPoint,
    ) {
        let Some((cell, terms)) = self.terms(stretch, index) else {
            return;
        };
        let found = adjoint.retreat(cell, &terms.dynamics, record);
        let segment_number = index / SEGMENT_CELLS;
        let own = stretch.own.get_mut(index);
        let segment = stretch.segments.get_mut(segment_number);
        if let (true, Some(own), Some(segment)) = (infers, own, segment) {
            let mut passed = PassedCell {
                cell,
                own,
                segment,
                segment_number,
                begins_segment: index.is_multiple_of(SEGMENT_CELLS),
                terms: &terms,
                found: &found,
            };
            fixed_point.infer(self.model.numbers, &self.levels, &mut passed);
        }
    }
}
