//! The window behind the vehicle: its cells are smoothed and weighed again and again.

use super::cell_model::CellModel;
use super::doubt::DoubtFinder;
use super::levels::{LevelSums, Levels};
use super::round::{Memory, Round, Stretch};
use super::variances::{CellVariances, SEGMENT_CELLS, SegmentVariances};
use crate::cell::CELL_LENGTH_M;
use crate::robust::vehicle_cells::EndedRest;
use crate::robust::{Adjoint, CellInput, Moments, Quantity, Record, State};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use heapless::Vec;

/// Cells between two updates of the window, two segments.
pub const UPDATE_CELLS: usize = 2 * SEGMENT_CELLS;
/// Cells of later measurements that a lagged estimate has at least, 500 m.
pub const LAG_CELLS: usize = 200;
/// Cells that stay in the window, 800 m.
const WINDOW_CELLS: usize = 16 * SEGMENT_CELLS;
/// Cells that it holds between two updates.
const CAPACITY: usize = WINDOW_CELLS + UPDATE_CELLS;
/// Cells between two stored states.
const BLOCK_CELLS: usize = SEGMENT_CELLS;
const BLOCKS: usize = CAPACITY / BLOCK_CELLS;
const SEGMENTS: usize = CAPACITY / SEGMENT_CELLS;
/// Slope beyond which a number has been lost, %.
const LARGEST_PERCENT: f32 = 1e3;
/// Rounds of an update.
const ROUNDS: usize = 2;

/// The window of a drive under one hypothesis.
#[derive(Clone, Debug)]
pub struct Window<S> {
    cells: Vec<CellInput, CAPACITY>,
    own: Vec<CellVariances, CAPACITY>,
    segments: Vec<SegmentVariances, SEGMENTS>,
    /// How the force was in doubt before the window.
    doubt: DoubtFinder,
    doubt_behind_leaving: DoubtFinder,
    /// The same up to the newest cell.
    newest_doubt: DoubtFinder,
    /// The state before the window.
    committed: State<S>,
    newest: State<S>,
    levels: Levels,
    /// Sums behind the levels of the cells before the window.
    past: LevelSums,
    undecided_variance: f32,
    undecided_from: usize,
    live_slope: f32,
    slopes: [Slope; CAPACITY],
    checkpoints: [State<S>; BLOCKS],
    records: [Record<S>; BLOCK_CELLS],
    has_begun: bool,
    restarts: u32,
}

/// A slope of the road with its variance.
pub type Slope = Moments<f32>;

impl<S: Scalar> Window<S> {
    /// Creates the window before the first cell. `overrun_is_doubtful` is the hypothesis that the bus
    /// does not report brakes.
    #[must_use]
    pub fn new(overrun_is_doubtful: bool) -> Self {
        Self {
            cells: Vec::new(),
            own: Vec::new(),
            segments: Vec::new(),
            doubt: DoubtFinder::new(overrun_is_doubtful),
            doubt_behind_leaving: DoubtFinder::new(overrun_is_doubtful),
            newest_doubt: DoubtFinder::new(overrun_is_doubtful),
            committed: State::ZERO,
            newest: State::ZERO,
            levels: Levels::ONE,
            past: LevelSums::default(),
            undecided_variance: 0.0,
            undecided_from: 0,
            live_slope: 0.0,
            slopes: [Slope {
                mean: 0.0,
                variance: 0.0,
            }; CAPACITY],
            checkpoints: [State::ZERO; BLOCKS],
            records: [Record::EMPTY; BLOCK_CELLS],
            has_begun: false,
            restarts: 0,
        }
    }

    /// Returns the levels so far.
    #[must_use]
    pub const fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Returns the state behind the newest cell.
    #[must_use]
    pub const fn newest(&self) -> &State<S> {
        &self.newest
    }

    /// Takes a cell, and the rest of the torque that ended in it. Returns the live slope at its end.
    pub fn push(
        &mut self,
        numbers: &Numbers,
        cell: &CellInput,
        rest: Option<&EndedRest>,
        cold_tyres_percent: f32,
    ) -> Slope {
        if !self.has_begun {
            self.has_begun = true;
            self.committed = State::at_start(numbers, cell, cold_tyres_percent);
            self.newest = self.committed;
        }
        let index = self.cells.len();
        if index.is_multiple_of(SEGMENT_CELLS) {
            let mut segment = SegmentVariances::start(numbers, numbers.live_multiplier);
            // A road that was smooth so far may bend here.
            segment.road *= Scalar::max(1.0, 1.0 / self.levels.road);
            let _ = self.segments.push(segment);
        }
        let mut own = CellVariances::START;
        self.newest_doubt.next(numbers, cell, &mut own);
        // There is room: an update makes it.
        let _ = self.cells.push(*cell);
        let _ = self.own.push(own);
        if let Some(rest) = rest {
            rest.mark(&mut self.cells);
        }
        self.step_live(numbers, cell, index)
    }

    fn step_live(&mut self, numbers: &Numbers, cell: &CellInput, index: usize) -> Slope {
        let round = Round {
            model: CellModel::new(numbers),
            levels: self.levels,
        };
        let stretch = Stretch {
            cells: &self.cells,
            own: &mut self.own,
            segments: &mut self.segments,
        };
        if let Some((_, terms)) = round.terms(&stretch, index) {
            let gate = S::from_f32(numbers.live_gate);
            round.step(&mut self.newest, cell, &terms, Some(gate));
        }
        let (slope, _) = self.newest.quantity(Quantity::RoadSlope);
        let slope = to_single(slope);
        let before = core::mem::replace(&mut self.live_slope, slope.mean);
        let timing = timing_variance(numbers, cell, slope_rate(before, slope.mean));
        let variance = slope.variance + self.undecided_variance + timing;
        let is_sound = self.newest.is_sound()
            && slope.mean.abs() < LARGEST_PERCENT
            && slope.variance >= 0.0
            && variance.is_finite();
        if !is_sound {
            self.restart();
            return Slope {
                mean: 0.0,
                variance: numbers.prior_slope_percent * numbers.prior_slope_percent,
            };
        }
        Slope {
            mean: slope.mean,
            variance,
        }
    }

    /// Forgets everything but the hypothesis: a number is not finite. The cells of the window are lost.
    fn restart(&mut self) {
        let hypothesis = self.newest_doubt.overrun_is_doubtful;
        self.restarts = self.restarts.saturating_add(1);
        (self.doubt, self.newest_doubt) =
            (DoubtFinder::new(hypothesis), DoubtFinder::new(hypothesis));
        self.cells.clear();
        self.own.clear();
        self.segments.clear();
        (self.levels, self.past) = (Levels::ONE, LevelSums::default());
        (self.undecided_variance, self.live_slope) = (0.0, 0.0);
        self.has_begun = false;
    }

    /// Returns how often the window started anew because a number was not finite.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Returns whether the window is to be updated.
    #[must_use]
    pub fn is_due(&self) -> bool {
        let count = self.cells.len();
        count > 0 && count.is_multiple_of(UPDATE_CELLS)
    }

    /// Infers the variances of the window anew, and drops the cells that leave it. `take` gets the
    /// lagged slopes of the cells whose lag is over, the oldest first, each with the number of cells
    /// behind it; at the end of a drive those of all cells that are left.
    pub fn update(&mut self, numbers: &Numbers, ends: bool, mut take: impl FnMut(usize, Slope)) {
        let leaving = self.cells.len().saturating_sub(WINDOW_CELLS) / UPDATE_CELLS * UPDATE_CELLS;
        for round in 1..=ROUNDS {
            self.run_round(numbers, if round == ROUNDS { leaving } else { 0 });
        }
        let count = self.cells.len();
        for (index, cell) in self.cells.iter().enumerate() {
            let behind = count - 1 - index;
            let is_due = behind < LAG_CELLS + UPDATE_CELLS && (ends || behind >= LAG_CELLS);
            let (Some(slope), true) = (self.slopes.get(index), is_due) else {
                continue;
            };
            let before = index
                .checked_sub(1)
                .and_then(|index| self.slopes.get(index));
            let rate = slope_rate(before.unwrap_or(slope).mean, slope.mean);
            let undecided = if index >= self.undecided_from {
                self.undecided_variance
            } else {
                0.0
            };
            let extra = undecided + timing_variance(numbers, cell, rate);
            take(
                behind,
                Slope {
                    mean: slope.mean,
                    variance: slope.variance + extra,
                },
            );
        }
        self.drop_first(leaving);
    }

    /// Runs one round over the window. The first `leaving` cells leave after it.
    fn run_round(&mut self, numbers: &Numbers, leaving: usize) {
        let mut doubt = self.doubt;
        for (index, (cell, own)) in self.cells.iter().zip(&mut self.own).enumerate() {
            if index == leaving {
                self.doubt_behind_leaving = doubt;
            }
            doubt.next(numbers, cell, own);
        }
        self.newest_doubt = doubt;
        let round = Round {
            model: CellModel::new(numbers),
            levels: self.levels,
        };
        let mut stretch = Stretch {
            cells: &self.cells,
            own: &mut self.own,
            segments: &mut self.segments,
        };
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        let slopes = &mut self.slopes;
        let take = |index: usize, record: &Record<S>, adjoint: &Adjoint<S>| {
            let slope = adjoint.smooth(&record.state, Quantity::RoadSlope);
            if let Some(place) = slopes.get_mut(index) {
                *place = to_single(slope);
            }
        };
        let found = round.run(
            &self.committed,
            &mut stretch,
            &mut memory,
            leaving,
            true,
            take,
        );
        if found.newest.is_sound() {
            self.newest = found.newest;
        }
        let fixed_point = &found.fixed_point;
        fixed_point.revive(numbers, &mut self.segments);
        self.undecided_variance = fixed_point.undecided_variance(numbers);
        self.undecided_from = fixed_point.likeliest.segment * SEGMENT_CELLS;
        let left_m = leaving as f32 * CELL_LENGTH_M;
        let kept = libm::expf(-left_m / numbers.level_memory_m);
        self.past = self.past.decayed_plus(kept, &found.leaving);
        let sums = self.past.decayed_plus(1.0, &fixed_point.sums);
        self.levels = sums.levels(numbers);
    }

    /// Drops the first cells: whole blocks, before which the states are stored.
    fn drop_first(&mut self, leaving: usize) {
        if leaving == 0 {
            return;
        }
        if let Some(state) = self.checkpoints.get(leaving / BLOCK_CELLS) {
            self.committed = *state;
        }
        self.doubt = self.doubt_behind_leaving;
        drop_first(&mut self.cells, leaving);
        drop_first(&mut self.own, leaving);
        drop_first(&mut self.segments, leaving / SEGMENT_CELLS);
    }
}

fn drop_first<T: Copy, const N: usize>(list: &mut Vec<T, N>, count: usize) {
    let held = list.len();
    let left = held.saturating_sub(count);
    list.copy_within(held - left.., 0);
    list.truncate(left);
}

fn to_single<S: Scalar>(moments: Moments<S>) -> Slope {
    Slope {
        mean: moments.mean.to_f32(),
        variance: moments.variance.to_f32(),
    }
}

fn slope_rate(before: f32, after: f32) -> f32 {
    (after - before) / CELL_LENGTH_M
}

/// Returns the variance of a slope by the age of the signals: the road behind the vehicle bends, %².
#[must_use]
pub fn timing_variance(numbers: &Numbers, cell: &CellInput, slope_rate: f32) -> f32 {
    let off = numbers.timing_s * cell.speed_mps * slope_rate;
    off * off
}
