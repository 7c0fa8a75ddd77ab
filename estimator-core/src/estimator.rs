//! The facade: frames and time stamps in, cells and a live estimate out.

mod creation;

use crate::cell::{Cell, CellEnd, Disagreement, Live};
use crate::context::Context;
use crate::counters::{Counters, count, count_by};
use crate::filter::{AltitudeEvent, Filter, ModelMass, SensorNoiseRatios, SlowStates};
use crate::intake::{Intake, Outcome};
use crate::model::Model;
use crate::persistent_state::PersistentState;
use crate::sample::Sample;
use crate::sampler::Sampler;
use crate::scalar::Scalar;
use crate::signal::{Reading, Signal};
use crate::smoother::FixedLag;
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use embedded_can::Frame;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// The filter moved over a cell. The event is what happened to an altitude, besides its use.
    Moved(Option<AltitudeEvent>),
    /// The cell has no estimate: no speed was received yet, or the filter was restarted.
    Skipped,
}

/// A grade estimator for one vehicle.
///
/// It does no input and output: feed it with [`on_frame`](Self::on_frame) (or
/// [`on_reading`](Self::on_reading) where there is no bus), let it work with [`step`](Self::step),
/// and fetch results with [`live`](Self::live) and [`next_cell`](Self::next_cell). It never
/// allocates, blocks or reads a clock. All input is checked, and what is unusable is counted in
/// [`counters`](Self::counters).
///
/// ```
/// use estimator_core::{Estimator, Traction, Tuning, VehicleParameters};
/// # use estimator_core::{Instant, Reading, Signal, Value};
/// let vehicle = VehicleParameters {
///     mass_kg: 19_000.0,
///     drag_area_m2: 5.2,
///     rolling_resistance: 0.008,
///     wheel_radius_m: 0.48,
///     wheel_inertia_kgm2: 60.0,
///     traction: Traction::Force,
/// };
/// let mut estimator = Estimator::<f32>::new(vehicle, Tuning::default())?;
/// # for second in 0..60 {
/// #     let now = Instant::from_micros(second * 1_000_000);
/// #     for (signal, value) in [(Signal::TractionForce, 2_000.0), (Signal::WheelSpeed, 10.0)] {
/// #         estimator.on_reading(now, Reading { signal, value: Value::Real(value) });
/// #     }
/// while estimator.step().is_some() {}
/// while let Some(cell) = estimator.next_cell() {
///     println!("{:.1} m {:.2} %", cell.end.distance_m(), cell.lagged_grade_percent.value);
/// }
/// # }
/// # assert!(estimator.live().is_some());
/// # Ok::<(), estimator_core::ParameterError>(())
/// ```
// In this order: the fields are written one by one where they stay (`creation`), and the compiler
// takes neighbours together over the stack if one is copied and the other one has nothing to write.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct Estimator<S> {
    context: Context,
    /// Of the model as given: the bus may change parameters of it.
    fingerprint: u32,
    intake: Intake,
    sampler: Sampler,
    filter: Filter<S>,
    lag: FixedLag<S>,
    end: CellEnd,
    disagreement: Disagreement,
    sample: Option<Sample>,
}

impl<S: Scalar> Estimator<S> {
    /// Reserves a signal for [`on_reading`](Self::on_reading), for a caller that decodes messages of
    /// its own ([`own_message`](crate::signal::own_message)). The built-in messages no longer give
    /// it; what they say of it counts as that of another source.
    pub fn reserve(&mut self, signal: Signal) {
        self.intake.reserve(signal);
    }

    /// Leaves out a signal from now on, as if the bus did not have it: for a sensor known to be
    /// wrong.
    pub fn ignore(&mut self, signal: Signal) {
        self.intake.ignore(signal);
    }

    /// Takes one frame, received at `now`.
    pub fn on_frame<F: Frame>(&mut self, now: Instant, frame: &F) -> Outcome {
        self.intake
            .on_frame(&mut self.context, now, frame, &mut self.sampler)
    }

    /// Takes one reading that comes without a bus. Readings of the same time go in the order of
    /// [`Signal`].
    pub fn on_reading(&mut self, now: Instant, reading: Reading) -> Outcome {
        self.intake
            .on_reading(&mut self.context, now, reading, &mut self.sampler)
    }

    /// Moves the filter over one cell. Returns `None` if no cell is ready; call it until then.
    pub fn step(&mut self) -> Option<Step> {
        let sample = self.sampler.move_next_to(&mut self.sample)?;
        let record = self.filter.step(&mut self.context, sample);
        let (Some(record), Some(state)) = (record, self.filter.state()) else {
            return Some(Step::Skipped);
        };
        self.end = record.end;
        self.disagreement = record.live_disagreement();
        let lost = self.lag.push(&record, state);
        count_by(&mut self.context.counters.cells_lost, lost);
        Some(Step::Moved(record.event))
    }

    /// Returns the estimate at the end of the newest cell; `None` before the first.
    #[must_use]
    pub fn live(&self) -> Option<Live> {
        let (state, sample) = (self.filter.state()?, self.sample()?);
        let mass = ModelMass::of(&self.context, sample);
        Some(Live {
            end: self.end,
            estimate: state.estimate(&mass),
            disagreement: self.disagreement,
        })
    }

    /// Returns the next finished cell, whose lag is over.
    #[inline(never)] // Called from several places.
    pub fn next_cell(&mut self) -> Option<Cell> {
        let cell = self.lag.next_cell();
        self.check_cell(cell)
    }

    /// Does a share of the work at the end of a drive, as long as that of [`step`](Self::step).
    /// Returns false when all cells are finished. Fetch them with [`next_cell`](Self::next_cell)
    /// after each share; the last ones are smoothed by less than the full lag. What comes after the
    /// end of a drive starts a new chain of cells.
    pub fn drain_step(&mut self) -> bool {
        let lost = self.lag.drain_step();
        count_by(&mut self.context.counters.cells_lost, lost.unwrap_or(0));
        lost.is_some()
    }

    /// Returns the next of the last cells of a drive. It does all work of
    /// [`drain_step`](Self::drain_step) that the cell needs at once: for callers that are not pressed
    /// for time.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        let cell = self.lag.drain_cell();
        self.check_cell(cell)
    }

    /// Counts a cell in which signals disagree, and one with a non-finite grade: a number type that
    /// is too narrow for the smoothing.
    fn check_cell(&mut self, cell: Option<Cell>) -> Option<Cell> {
        if let Some(cell) = &cell {
            let counters = &mut self.context.counters;
            if !cell.lagged_consistent {
                count(&mut counters.cells_suspect);
            }
            if !(cell.lagged_grade_percent.value + cell.lagged_grade_percent.sigma).is_finite() {
                count(&mut counters.cells_unsound);
            }
        }
        cell
    }

    /// Returns the sample of the last step, for a second pass over a whole run on a host.
    #[must_use]
    pub const fn sample(&self) -> Option<&Sample> {
        self.sample.as_ref()
    }

    /// Returns the age of a GNSS fix when it arrives, by which fixes are placed: that which the drive
    /// has shown so far, or the assumed one.
    #[must_use]
    pub fn gnss_latency(&self) -> Duration {
        self.sampler.gnss_latency(self.tuning())
    }

    /// Returns what this drive leaves for the next one. It is `None` before 5 km with GNSS, and if
    /// the state is outside its possible range. It may be taken at any time: its variances say how
    /// much was learned.
    #[must_use]
    pub fn persistent_state(&self) -> Option<PersistentState> {
        let counters = self.counters();
        let Tuning {
            detection,
            measurement_noise,
            ..
        } = self.tuning();
        if counters.steps < detection.persist_cells
            || counters.altitudes_used < detection.persist_altitudes
        {
            return None;
        }
        let slow = SlowStates::of(self.filter.state()?, self.sample()?.forces.mass_kg);
        let sensors = self.filter.body_sensors(self.tuning());
        PersistentState::new(
            self.fingerprint,
            measurement_noise,
            slow,
            &self.noise(),
            sensors,
        )
    }

    /// Returns a filter for a second pass over this drive ([`Filter::second_pass`]).
    #[must_use]
    pub fn second_pass_filter<T: Scalar>(&self) -> Filter<T> {
        self.filter.second_pass(self.tuning())
    }

    /// Returns what has been learned of the sensors' noise.
    #[must_use]
    pub const fn noise(&self) -> SensorNoiseRatios {
        self.filter.noise()
    }

    /// Returns the counts of what happened so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.context.counters
    }

    /// Returns what the parts of the estimator share: model, tuning and counters.
    #[must_use]
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Returns the tuning.
    #[must_use]
    pub const fn tuning(&self) -> &Tuning {
        &self.context.tuning
    }

    /// Returns the model of the vehicle that is in use. Its reference torque and engine inertia are
    /// those that the bus reports (EC1), if they differ from the given ones.
    #[must_use]
    pub const fn model(&self) -> &Model {
        &self.context.model
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::cell::Uncertain;
    use crate::vehicle::{Traction, VehicleParameters};

    #[test]
    fn finished_cells_in_which_signals_disagree_and_unsound_ones_are_counted() {
        let vehicle = VehicleParameters {
            mass_kg: 19_000.0,
            drag_area_m2: 5.2,
            rolling_resistance: 0.008,
            wheel_radius_m: 0.48,
            wheel_inertia_kgm2: 60.0,
            traction: Traction::Force,
        };
        let mut estimator = Estimator::<f32>::new(vehicle, Tuning::default()).unwrap();
        let cell = |lagged_consistent| Cell {
            end: CellEnd::default(),
            live_grade_percent: Uncertain::default(),
            lagged_grade_percent: Uncertain::default(),
            altitude_m: None,
            live_consistent: false,
            lagged_consistent,
        };
        for is_consistent in [true, false, false] {
            estimator.check_cell(Some(cell(is_consistent)));
        }
        estimator.check_cell(None);
        assert_eq!(estimator.counters().cells_suspect, 2);
        assert_eq!(estimator.counters().cells_unsound, 0);
        let unsound = |value, sigma| Cell {
            lagged_grade_percent: Uncertain { value, sigma },
            ..cell(true)
        };
        for (value, sigma) in [(f32::NAN, 0.1), (1.0, f32::INFINITY)] {
            estimator.check_cell(Some(unsound(value, sigma)));
        }
        assert_eq!(estimator.counters().cells_unsound, 2);
    }
}
