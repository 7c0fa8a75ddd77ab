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
/// Force beyond which a brake is hidden, %, at a distance of four sigmas.
const HIDDEN_BRAKE_PERCENT: f32 = 1.0;
/// Distance over which brakes must have been hidden for the bus to count as one without them, m.
const HIDDEN_BRAKE_M: f32 = 20.0;
/// Rounds of a trial of that hypothesis.
const TRIAL_ROUNDS: usize = 5;
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
    /// Doubtful force of each cell, %.
    doubtful_force: [f32; CAPACITY],
    /// Whether the force steps by more than the model's error can.
    force_steps: bool,
    /// Cells in which brakes acted that no signal reported.
    hidden_brake_cells: usize,
    checkpoints: [State<S>; BLOCKS],
    trial_checkpoints: [State<S>; BLOCKS],
    records: [Record<S>; BLOCK_CELLS],
    has_begun: bool,
    restarts: u32,
}

/// A slope of the road with its variance.
pub type Slope = Moments<f32>;

/// What the window says of the end of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSlope {
    /// The slope of the road.
    pub slope: Slope,
    /// Whether no step of the force, no doubtful force and no undecided step is found there.
    pub is_consistent: bool,
}

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
            doubtful_force: [0.0; CAPACITY],
            force_steps: false,
            hidden_brake_cells: 0,
            checkpoints: [State::ZERO; BLOCKS],
            trial_checkpoints: [State::ZERO; BLOCKS],
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
    ) -> CellSlope {
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

    fn step_live(&mut self, numbers: &Numbers, cell: &CellInput, index: usize) -> CellSlope {
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
            let variance = numbers.prior_slope_percent * numbers.prior_slope_percent;
            return CellSlope {
                slope: Slope {
                    mean: 0.0,
                    variance,
                },
                is_consistent: false,
            };
        }
        CellSlope {
            slope: Slope {
                mean: slope.mean,
                variance,
            },
            is_consistent: !self.is_undecided(numbers),
        }
    }

    /// Returns whether a step is neither certain nor excluded that would move the slope.
    fn is_undecided(&self, numbers: &Numbers) -> bool {
        let least = numbers.inconsistent_percent;
        self.undecided_variance > least * least
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

    /// Returns whether overrun counts as doubtful: brakes act that no signal reports.
    #[must_use]
    pub const fn hides_brakes(&self) -> bool {
        self.doubt.overrun_is_doubtful
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
    pub fn update(
        &mut self,
        numbers: &Numbers,
        ends: bool,
        mut take: impl FnMut(usize, CellSlope),
    ) {
        let count = self.cells.len();
        let leaving = count.saturating_sub(WINDOW_CELLS) / UPDATE_CELLS * UPDATE_CELLS;
        let first_due = count.saturating_sub(LAG_CELLS + UPDATE_CELLS);
        for _ in 1..ROUNDS {
            self.run_round(numbers, 0, count);
        }
        // The one before the first that is due gives its slope rate.
        self.run_round(numbers, leaving, first_due.saturating_sub(1));
        self.look_for_hidden_brakes(numbers);
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
            let slope = Slope {
                mean: slope.mean,
                variance: slope.variance + extra,
            };
            let is_consistent = !self.is_doubtful(numbers, index)
                && (undecided == 0.0 || !self.is_undecided(numbers));
            take(
                behind,
                CellSlope {
                    slope,
                    is_consistent,
                },
            );
        }
        self.drop_first(leaving);
    }

    /// Returns whether the force is in doubt, or steps, in a cell of the window.
    fn is_doubtful(&self, numbers: &Numbers, index: usize) -> bool {
        let least = numbers.inconsistent_percent;
        let force_percent = self.doubtful_force.get(index).copied().unwrap_or(0.0);
        let segment = self.segments.get(index / SEGMENT_CELLS);
        force_percent.abs() > least
            || segment.is_some_and(|segment| segment.bias_shock > least * least)
    }

    /// Runs one round over the window. The first `leaving` cells leave after it. It smooths the slopes
    /// from the cell `smoothed_from` on.
    fn run_round(&mut self, numbers: &Numbers, leaving: usize, smoothed_from: usize) {
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
        let (slopes, forces) = (&mut self.slopes, &mut self.doubtful_force);
        let take = |index: usize, record: &Record<S>, adjoint: &Adjoint<S>| {
            if index < smoothed_from {
                return;
            }
            let slope = adjoint.smooth(&record.state, Quantity::RoadSlope);
            let force = adjoint.smooth(&record.state, Quantity::DoubtfulForce);
            if let (Some(slopes), Some(forces)) = (slopes.get_mut(index), forces.get_mut(index)) {
                (*slopes, *forces) = (to_single(slope), force.mean.to_f32());
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
        self.force_steps = fixed_point.bias_step.evidence > numbers.revive
            && fixed_point.bias_step.size_percent.abs() > HIDDEN_BRAKE_PERCENT;
    }

    /// Looks whether brakes act that no signal reports, where the force steps and the engine drives
    /// nothing: it infers the window once more under that hypothesis. What it finds behind the lag
    /// counts.
    fn look_for_hidden_brakes(&mut self, numbers: &Numbers) {
        let overruns = |cell: &&CellInput| cell.marks.overrun && !cell.marks.invalid;
        let most = numbers.bias_shock_most_percent;
        let steps = self.force_steps
            || self
                .segments
                .iter()
                .any(|segment| segment.bias_shock > 0.25 * most * most);
        if self.doubt.overrun_is_doubtful
            || !steps
            || !self.cells.iter().any(|cell| overruns(&cell))
        {
            return;
        }
        // On variances of its own: the window's stay as they are.
        let (mut own, mut segments) = (self.own.clone(), self.segments.clone());
        let mut doubt = self.doubt;
        doubt.overrun_is_doubtful = true;
        for (cell, own) in self.cells.iter().zip(&mut own) {
            *own = CellVariances::START;
            doubt.next(numbers, cell, own);
        }
        segments.fill(SegmentVariances::start(numbers, 1.0));
        let round = Round {
            model: CellModel::new(numbers),
            levels: self.levels,
        };
        let behind_lag = self.cells.len().saturating_sub(LAG_CELLS + UPDATE_CELLS)
            ..self.cells.len().saturating_sub(LAG_CELLS);
        let cells = &self.cells;
        let mut hidden = 0;
        for trial in 1..=TRIAL_ROUNDS {
            let mut stretch = Stretch {
                cells,
                own: &mut own,
                segments: &mut segments,
            };
            let mut memory = Memory {
                checkpoints: &mut self.trial_checkpoints,
                records: &mut self.records,
            };
            let take = |index: usize, record: &Record<S>, adjoint: &Adjoint<S>| {
                let is_candidate = trial == TRIAL_ROUNDS
                    && behind_lag.contains(&index)
                    && cells.get(index).is_some_and(|cell| overruns(&cell));
                if is_candidate {
                    let force = to_single(adjoint.smooth(&record.state, Quantity::DoubtfulForce));
                    let sigma = Scalar::sqrt(force.variance);
                    hidden += usize::from(force.mean - 4.0 * sigma > HIDDEN_BRAKE_PERCENT);
                }
            };
            round.run(&self.committed, &mut stretch, &mut memory, 0, true, take);
        }
        self.hidden_brake_cells += hidden;
        if self.hidden_brake_cells as f32 * CELL_LENGTH_M > HIDDEN_BRAKE_M {
            self.doubt.overrun_is_doubtful = true;
            self.newest_doubt.overrun_is_doubtful = true;
            self.doubt_behind_leaving.overrun_is_doubtful = true;
        }
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
