//! The variances of a stretch of a run, inferred from all of it.

use estimator_core::filter::{Adjoint, CellInput, Record, State};
use estimator_core::inference::doubt::DoubtFinder;
use estimator_core::inference::round::{Memory, Pass};
use estimator_core::inference::{
    CellModel, CellTerms, CellVariances, HiddenBrakes, Levels, Round, SEGMENT_CELLS,
    SegmentVariances, Stretch,
};
use estimator_core::tuning::Numbers;

/// Cells whose records are held at once.
const BLOCK: usize = 2_048;
/// Rounds of the inference. With 16, errors of judged drives are 0.4 % smaller, those of the replicas of
/// the thesis 3 % larger.
const ROUNDS: usize = 10;
/// Rounds that tell whether overrun hides brakes.
const BRAKE_ROUNDS: usize = 5;

/// The variances of a stretch, and the memory of the passes over it.
pub struct Inferred<'a> {
    numbers: &'a Numbers,
    cells: &'a [CellInput],
    start: State<f64>,
    own: Vec<CellVariances>,
    segments: Vec<SegmentVariances>,
    round: Round<'a>,
    checkpoints: Vec<State<f64>>,
    records: Vec<Record<f64>>,
}

impl<'a> Inferred<'a> {
    /// Infers the variances of a stretch before which the filter is at `start`. Without signals of
    /// brakes, overrun may hide them: that is tried first.
    pub fn of(
        numbers: &'a Numbers,
        cells: &'a [CellInput],
        start: State<f64>,
        hides_brakes: bool,
    ) -> Self {
        let hides_brakes = hides_brakes
            || cells.iter().any(HiddenBrakes::could_be_in)
                && Self::after(numbers, cells, start, true, BRAKE_ROUNDS).hides_brakes();
        Self::after(numbers, cells, start, hides_brakes, ROUNDS)
    }

    /// Infers them in so many rounds.
    pub fn after(
        numbers: &'a Numbers,
        cells: &'a [CellInput],
        start: State<f64>,
        overrun_is_doubtful: bool,
        rounds: usize,
    ) -> Self {
        let mut own = vec![CellVariances::START; cells.len()];
        let mut doubt = DoubtFinder::new(overrun_is_doubtful);
        for (cell, own) in cells.iter().zip(&mut own) {
            doubt.next(numbers, cell, own);
        }
        let segments = cells.len().div_ceil(SEGMENT_CELLS);
        let mut inferred = Self {
            numbers,
            cells,
            start,
            own,
            segments: vec![SegmentVariances::start(numbers, 1.0); segments],
            round: Round {
                model: CellModel::new(numbers),
                levels: Levels::ONE,
                infers: true,
                leaving: 0,
            },
            checkpoints: vec![State::ZERO; cells.len().div_ceil(BLOCK)],
            records: vec![Record::EMPTY; BLOCK.min(cells.len())],
        };
        for _ in 1..rounds {
            inferred.infer();
        }
        inferred.round.infers = false;
        inferred
    }

    /// Infers the variances once more.
    fn infer(&mut self) {
        let found = self.back(|_, _, _| ()).found;
        found.revive(self.numbers, &mut self.segments);
        self.round.levels = found.sums.levels(self.numbers);
    }

    /// Goes over the stretch and back. `take` gets each cell's index, record, and what later cells say,
    /// the last cell first.
    pub fn back(&mut self, take: impl FnMut(usize, &Record<f64>, &Adjoint<f64>)) -> Pass<f64> {
        let mut stretch = Stretch {
            cells: self.cells,
            own: &mut self.own,
            segments: &mut self.segments,
        };
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        self.round.run(&self.start, &mut stretch, &mut memory, take)
    }

    /// Goes over the stretch. `take` gets each cell's index, the cell, its terms, and the record of the
    /// step.
    pub fn forward(
        &mut self,
        mut take: impl FnMut(usize, &CellInput, &CellTerms<f64>, &Record<f64>),
    ) {
        let stretch = Stretch {
            cells: self.cells,
            own: &mut self.own,
            segments: &mut self.segments,
        };
        let (mut state, mut record) = (self.start, Record::EMPTY);
        for index in 0..self.cells.len() {
            if let Some((cell, terms)) = self.round.terms(&stretch, index) {
                self.round.step(&mut state, cell, &terms, None, &mut record);
                take(index, cell, &terms, &record);
            }
        }
    }

    /// Returns the variance of a step of the bias at the start of a cell's segment, %².
    pub fn bias_shock(&self, cell: usize) -> f32 {
        self.segments[cell / SEGMENT_CELLS].bias_shock
    }

    /// Returns whether brakes act that no signal reports.
    fn hides_brakes(mut self) -> bool {
        let (cells, mut hidden) = (self.cells, HiddenBrakes::NONE);
        self.back(|index, record, later| hidden.take(&cells[index], record, later));
        hidden.are_found()
    }
}
