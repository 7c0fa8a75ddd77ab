//! A piece of a run: its cells, and the estimates of all of them.

use super::inferred::Inferred;
use super::smoothed_cell::SmoothedCell;
use estimator_core::filter::{
    CellInput, Measurand, Measurement, ModelMass, Moments, Quantity, SlowStates, State,
    VehicleCells, initial_state,
};
use estimator_core::inference::window::{of_doubtful_force, timing_variance};
use estimator_core::tuning::Numbers;
use estimator_core::{CELL_LENGTH_M, CellEnd, Context, Disagreement, Estimate, Sample, Uncertain};

/// Takes a measurement, and the end of its cell.
pub type MeasurementSink<'a, E> = dyn FnMut(&CellEnd, &Measurement<f64>) -> Result<(), E> + 'a;

/// The end of a cell, and what the sample says besides.
#[derive(Clone, Copy, Debug)]
struct End {
    end: CellEnd,
    mass: ModelMass,
    /// What the sampler found.
    signals: Disagreement,
    /// Whether it belongs to the piece, and not to its overlap.
    is_own: bool,
}

/// The cells of a piece.
#[derive(Default)]
pub struct Piece {
    /// The cells.
    pub cells: Vec<CellInput>,
    ends: Vec<End>,
    start: Option<State<f64>>,
}

impl Piece {
    /// Adds the cell of a sample.
    pub fn push(
        &mut self,
        context: &Context,
        known: Option<&SlowStates>,
        maker: &mut VehicleCells,
        sample: &Sample,
        is_own: bool,
    ) {
        let numbers = &context.tuning.estimation;
        let Some(mut cell) = maker.next(numbers, context, sample, known) else {
            return;
        };
        // What is before the piece is not known in it.
        cell.marks.gap |= self.cells.is_empty();
        let start = || initial_state(known, context, sample, &cell);
        self.start.get_or_insert_with(start);
        self.cells.push(cell);
        self.ends.push(End {
            end: sample.end,
            mass: ModelMass::of(context, sample),
            signals: sample.disagreement,
            is_own,
        });
        let noticed_late = usize::from(sample.disagreeing_cells);
        for end in self.ends.iter_mut().rev().take(noticed_late) {
            end.signals = end.signals.or(sample.disagreement);
        }
        if let Some(doubt) = maker.doubt_behind(&context.tuning, sample) {
            doubt.mark(&mut self.cells);
        }
    }

    /// Infers the variances. `hides_brakes` is whether an earlier drive found brakes that no signal
    /// reports. Returns `None` without a cell.
    pub fn infer<'a>(&'a self, numbers: &'a Numbers, hides_brakes: bool) -> Option<Inferred<'a>> {
        Some(Inferred::of(
            numbers,
            &self.cells,
            self.start?,
            hides_brakes,
        ))
    }

    /// Infers the variances in so many rounds, as if signals reported all brakes.
    pub fn infer_quickly<'a>(
        &'a self,
        numbers: &'a Numbers,
        rounds: usize,
    ) -> Option<Inferred<'a>> {
        Some(Inferred::after(
            numbers,
            &self.cells,
            self.start?,
            false,
            rounds,
        ))
    }

    /// Smooths the cells that are its own, and returns what disagrees in each.
    pub fn smooth(
        &self,
        numbers: &Numbers,
        inferred: &mut Inferred<'_>,
        origin_m: Option<f32>,
    ) -> Vec<(SmoothedCell, Disagreement)> {
        let mut smoothed = vec![Smoothed::NONE; self.cells.len()];
        inferred.back(|index, record, adjoint| {
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
        let own = self.ends.iter().enumerate().filter(|(_, end)| end.is_own);
        own.map(|(index, end)| {
            let found = self.disagreement(numbers, index, &smoothed[index], inferred);
            let variance = smoothed[index].slope.variance as f32;
            let disagreement = found
                .where_uncertain(variance, numbers.inconsistent_percent)
                .or(end.signals);
            let cell = SmoothedCell {
                end: end.end,
                estimate: self.estimate(numbers, index, &smoothed, origin_m),
                is_consistent: disagreement.is_none(),
            };
            (cell, found.or(end.signals))
        })
        .collect()
    }

    /// Passes the measurements of the cells that are its own to `take`, as the filter met them on its
    /// last way forward. Altitudes are those of the receiver.
    ///
    /// # Errors
    /// Returns the first error of `take`.
    pub fn measurements<E>(
        &self,
        inferred: &mut Inferred<'_>,
        origin_m: Option<f32>,
        take: &mut MeasurementSink<'_, E>,
    ) -> Result<(), E> {
        let origin_m = origin_m.map_or(0.0, f64::from);
        let mut taken = Ok(());
        inferred.forward(|index, cell, terms, record| {
            let End { end, is_own, .. } = &self.ends[index];
            let measurements = record.measurements(cell, &terms.noise);
            for mut measurement in measurements.into_iter().flatten() {
                if measurement.measurand == Measurand::Altitude {
                    measurement.observation += origin_m;
                }
                if *is_own && taken.is_ok() {
                    taken = take(end, &measurement);
                }
            }
        });
        taken
    }

    fn estimate(
        &self,
        numbers: &Numbers,
        index: usize,
        smoothed: &[Smoothed],
        origin_m: Option<f32>,
    ) -> Estimate {
        let own = &smoothed[index];
        let (before, after) = (index.saturating_sub(1), (index + 1).min(smoothed.len() - 1));
        let length_m = (after - before) as f32 * CELL_LENGTH_M;
        let rise = (smoothed[after].slope.mean - smoothed[before].slope.mean) as f32;
        let rate = if length_m > 0.0 { rise / length_m } else { 0.0 };
        let timing = timing_variance(numbers, self.cells[index].speed_mps, rate);
        let scale = uncertain(own.scale).plus(1.0);
        Estimate {
            grade_percent: own.slope.to_single().widened(timing).grade(),
            altitude_m: origin_m.map(|origin_m| uncertain(own.altitude).plus(origin_m)),
            speed_mps: (2.0 * own.energy.mean).max(0.0).sqrt() as f32,
            bias_percent: uncertain(own.model_error),
            scale,
            mass_kg: self.ends[index].mass.gross_kg(scale),
        }
    }

    /// Returns what disagrees in a cell: which variance has opened there.
    fn disagreement(
        &self,
        numbers: &Numbers,
        index: usize,
        smoothed: &Smoothed,
        inferred: &Inferred<'_>,
    ) -> Disagreement {
        let least_percent = numbers.inconsistent_percent;
        let force_percent = smoothed.doubtful_force.mean as f32;
        Disagreement {
            climb: inferred.bias_shock(index) > least_percent * least_percent,
            ..of_doubtful_force(numbers, &self.cells[index], force_percent)
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

impl Smoothed {
    const NONE: Self = {
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
    };
}

fn uncertain(moments: Moments<f64>) -> Uncertain {
    moments.to_single().uncertain()
}
