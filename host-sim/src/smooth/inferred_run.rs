//! Smoothing of a whole run with inferred variances, piece by piece.
//!
//! A piece is long beside all that the filter remembers, and overlaps its neighbours by some
//! kilometres. Memory therefore does not grow with the run.

use super::disagreements::Disagreements;
use super::filtered_cell::WholeCell;
use super::samples::Samples;
use super::whole_run::SmoothedCell;
use estimator_core::filter::ModelMass;
use estimator_core::inference::doubt::DoubtFinder;
use estimator_core::inference::round::{Found, Memory};
use estimator_core::inference::window::timing_variance;
use estimator_core::inference::{
    CellModel, CellVariances, Levels, Numbers, Round, SEGMENT_CELLS, SegmentVariances, Stretch,
};
use estimator_core::robust::vehicle_cells::EndedRest;
use estimator_core::robust::{Adjoint, CellInput, Moments, Quantity, Record, State, VehicleCells};
use estimator_core::{CELL_LENGTH_M, Context, Disagreement, Estimate, Sample, Uncertain};

/// Cells of a piece, 100 km.
const PIECE: usize = 40_000;
/// Cells by which it goes beyond its ends, 10 km.
const OVERLAP: usize = 4_000;
/// Cells whose records are held at once.
const BLOCK: usize = 2_048;
/// Rounds of the inference.
const ROUNDS: usize = 16;
/// Rounds that tell whether overrun hides brakes.
const BRAKE_ROUNDS: usize = 8;
/// Length over which brakes must be hidden for the whole run to count as one without brake signals, m.
const HIDDEN_BRAKE_M: f32 = 20.0;
/// Force beyond which a brake is hidden, %, at a distance of four sigmas.
const HIDDEN_BRAKE_PERCENT: f64 = 1.0;

/// Smooths a run. `take` gets the cells from the first speed on, piece by piece in the order of the
/// run, with the index of the first one. Returns where signals disagree.
///
/// # Errors
/// Returns the error of `samples` or of `take`.
pub fn smooth_inferred<M: Samples>(
    context: &Context,
    samples: &mut M,
    mut take: impl FnMut(usize, Vec<SmoothedCell>) -> Result<(), M::Error>,
) -> Result<Disagreements, M::Error> {
    let numbers = &Numbers::default();
    let mut disagreements = Disagreements::default();
    let all = samples.count();
    let mut maker = VehicleCells::default();
    let (mut done, mut given) = (0, 0);
    while done < all {
        let end = (done + PIECE).min(all);
        let range = done.saturating_sub(OVERLAP)..(end + OVERLAP).min(all);
        let mut piece = Piece::default();
        let next_start = end.saturating_sub(OVERLAP);
        let mut at = range.start;
        let mut next_maker = None;
        samples.each(range, |sample| {
            if at == next_start {
                next_maker = Some(maker.clone());
            }
            piece.push(
                numbers,
                context,
                &mut maker,
                sample,
                (done..end).contains(&at),
            );
            at += 1;
        })?;
        if let Some(next) = next_maker {
            maker = next;
        }
        let cells = piece.smooth(numbers, context, maker.origin_m());
        let count = cells.len();
        for (cell, disagreement) in &cells {
            disagreements.add(*disagreement, cell.end.cell);
        }
        take(given, cells.into_iter().map(|(cell, _)| cell).collect())?;
        given += count;
        done = end;
    }
    Ok(disagreements)
}

/// The cells of a piece.
#[derive(Default)]
struct Piece {
    cells: Vec<CellInput>,
    ends: Vec<WholeCell>,
}

impl Piece {
    fn push(
        &mut self,
        numbers: &Numbers,
        context: &Context,
        maker: &mut VehicleCells,
        sample: &Sample,
        is_own: bool,
    ) {
        let Some(cell) = maker.next(numbers, context, sample) else {
            return;
        };
        self.cells.push(cell);
        self.ends.push(WholeCell {
            end: sample.end,
            mass: ModelMass::of(context, sample),
            is_own,
        });
        if let Some(rest) = EndedRest::of(numbers, sample) {
            rest.mark(&mut self.cells);
        }
    }

    /// Infers the variances, and returns the cells that are its own.
    fn smooth(
        &self,
        numbers: &Numbers,
        context: &Context,
        origin_m: Option<f32>,
    ) -> Vec<(SmoothedCell, Disagreement)> {
        if self.cells.is_empty() {
            return Vec::new();
        }
        let cold = numbers.prior_cold_tyre * context.model.vehicle.rolling_resistance;
        let start = State::at_start(numbers, &self.cells[0], 100.0 * cold);
        let trial = Inferred::new(numbers, &self.cells, start, true);
        let hides_brakes = trial.hidden_brake_m(BRAKE_ROUNDS) > HIDDEN_BRAKE_M;
        let mut inferred = Inferred::new(numbers, &self.cells, start, hides_brakes);
        for _ in 1..ROUNDS {
            inferred.infer();
        }
        let estimates = inferred.estimates(&self.ends, origin_m);
        let own = self
            .ends
            .iter()
            .zip(estimates)
            .filter(|(end, _)| end.is_own);
        own.map(|(end, (estimate, disagreement))| {
            let cell = SmoothedCell {
                end: end.end,
                estimate,
                is_consistent: disagreement.is_none(),
            };
            (cell, disagreement)
        })
        .collect()
    }
}

/// The variances of a piece, and the memory of its passes.
struct Inferred<'a> {
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
    fn new(
        numbers: &'a Numbers,
        cells: &'a [CellInput],
        start: State<f64>,
        overrun_is_doubtful: bool,
    ) -> Self {
        let mut own = vec![CellVariances::START; cells.len()];
        let mut doubt = DoubtFinder::new(overrun_is_doubtful);
        for (cell, own) in cells.iter().zip(&mut own) {
            doubt.next(numbers, cell, own);
        }
        let segments = cells.len().div_ceil(SEGMENT_CELLS);
        Self {
            numbers,
            cells,
            start,
            own,
            segments: vec![SegmentVariances::start(numbers, 1.0); segments],
            round: Round {
                model: CellModel::new(numbers),
                levels: Levels::ONE,
            },
            checkpoints: vec![State::ZERO; cells.len().div_ceil(BLOCK)],
            records: vec![Record::EMPTY; BLOCK.min(cells.len())],
        }
    }

    /// Runs one round.
    fn run(
        &mut self,
        infers: bool,
        take: impl FnMut(usize, &Record<f64>, &Adjoint<f64>),
    ) -> Found<f64> {
        let mut stretch = Stretch {
            cells: self.cells,
            own: &mut self.own,
            segments: &mut self.segments,
        };
        let mut memory = Memory {
            checkpoints: &mut self.checkpoints,
            records: &mut self.records,
        };
        self.round
            .run(&self.start, &mut stretch, &mut memory, 0, infers, take)
    }

    /// Runs one round, and infers the variances.
    fn infer(&mut self) {
        let found = self.run(true, |_, _, _| ());
        found.fixed_point.revive(self.numbers, &mut self.segments);
        self.round.levels = found.fixed_point.sums.levels(self.numbers);
    }

    /// Returns over which distance brakes act that no signal reports, m.
    fn hidden_brake_m(mut self, rounds: usize) -> f32 {
        if !self.cells.iter().any(|cell| cell.marks.overrun) {
            return 0.0;
        }
        for _ in 1..rounds {
            self.infer();
        }
        let (cells, mut hidden) = (self.cells, 0);
        self.run(false, |index, record, adjoint| {
            let marks = &cells[index].marks;
            if !marks.overrun || marks.invalid {
                return;
            }
            let force = adjoint.smooth(&record.state, Quantity::DoubtfulForce);
            if force.mean - 4.0 * force.variance.sqrt() > HIDDEN_BRAKE_PERCENT {
                hidden += 1;
            }
        });
        hidden as f32 * CELL_LENGTH_M
    }

    /// Returns the estimate of each cell, and what disagrees there.
    fn estimates(
        &mut self,
        ends: &[WholeCell],
        origin_m: Option<f32>,
    ) -> Vec<(Estimate, Disagreement)> {
        let mut smoothed = vec![Smoothed::default(); self.cells.len()];
        self.run(false, |index, record, adjoint| {
            let of = |quantity| adjoint.smooth(&record.state, quantity);
            smoothed[index] = Smoothed {
                slope: of(Quantity::RoadSlope),
                altitude: of(Quantity::Altitude),
                energy: of(Quantity::KineticEnergy),
                model_error: of(Quantity::ModelError),
                scale: of(Quantity::Scale),
                doubtful_force: of(Quantity::DoubtfulForce),
            };
        });
        let count = smoothed.len();
        let estimate = |index: usize| {
            let own = &smoothed[index];
            let (before, after) = (index.saturating_sub(1), (index + 1).min(count - 1));
            let length_m = (after - before) as f32 * CELL_LENGTH_M;
            let rise = (smoothed[after].slope.mean - smoothed[before].slope.mean) as f32;
            let rate = if length_m > 0.0 { rise / length_m } else { 0.0 };
            let timing = timing_variance(self.numbers, &self.cells[index], rate);
            let scale = uncertain(own.scale).plus(1.0);
            let estimate = Estimate {
                grade_percent: grade(own.slope, timing),
                altitude_m: origin_m.map(|origin_m| uncertain(own.altitude).plus(origin_m)),
                speed_mps: (2.0 * own.energy.mean).max(0.0).sqrt() as f32,
                bias_percent: uncertain(own.model_error),
                scale,
                mass_kg: ends[index].mass.gross_kg(scale),
            };
            (estimate, self.disagreement(index, own))
        };
        (0..count).map(estimate).collect()
    }

    /// Returns what disagrees in a cell: which variance has opened there.
    fn disagreement(&self, index: usize, smoothed: &Smoothed) -> Disagreement {
        let least_percent = self.numbers.inconsistent_percent;
        let least = least_percent * least_percent;
        let cell = &self.cells[index];
        let doubts = smoothed.doubtful_force.mean.abs() > f64::from(least_percent);
        Disagreement {
            climb: self.segments[index / SEGMENT_CELLS].bias_shock > least,
            brake: doubts && cell.marks.overrun,
            torque: doubts && !cell.marks.overrun && cell.rest_percent > 0.0,
            ..Disagreement::default()
        }
    }
}

/// The quantities of a cell.
#[derive(Clone, Copy)]
struct Smoothed {
    slope: Moments<f64>,
    altitude: Moments<f64>,
    energy: Moments<f64>,
    model_error: Moments<f64>,
    scale: Moments<f64>,
    doubtful_force: Moments<f64>,
}

impl Default for Smoothed {
    fn default() -> Self {
        let none = Moments {
            mean: 0.0,
            variance: 0.0,
        };
        Self {
            slope: none,
            altitude: none,
            energy: none,
            model_error: none,
            scale: none,
            doubtful_force: none,
        }
    }
}

fn uncertain(moments: Moments<f64>) -> Uncertain {
    Uncertain {
        value: moments.mean as f32,
        sigma: moments.variance.max(0.0).sqrt() as f32,
    }
}

/// Returns the grade of a slope, whose variance grows by another one.
fn grade(slope: Moments<f64>, extra: f32) -> Uncertain {
    let single = Moments {
        mean: slope.mean as f32,
        variance: slope.variance as f32 + extra,
    };
    single.grade()
}
