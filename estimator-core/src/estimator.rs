//! The facade: frames and time stamps in, cells and a live estimate out.

mod cell_estimator;
mod creation;
mod waiting;

pub use cell_estimator::CellEstimator;

use crate::cell::{Cell, Live};
use crate::context::Context;
use crate::counters::Counters;
use crate::delay::Delays;
use crate::filter::SlowStates;
use crate::intake::{Intake, Outcome};
use crate::model::Model;
use crate::persistent_state::PersistentState;
use crate::sample::Sample;
use crate::sampler::Sampler;
use crate::scalar::Scalar;
use crate::signal::{Reading, Signal};
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use embedded_can::Frame;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// The filter moved over a cell.
    Moved,
    /// The cell has no estimate: no speed was received yet.
    Skipped,
    /// A share of the work on the lagged estimates is done. No cell was taken.
    Smoothed,
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
    chain: CellEstimator<S>,
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

    /// Does a share of work: moves the filter over one cell, or goes on with the lagged estimates.
    /// Returns `None` if nothing is left to do; call it until then. Each share is short.
    pub fn step(&mut self) -> Option<Step> {
        if self.chain.work(&self.context) {
            return Some(Step::Smoothed);
        }
        let sample = self.sampler.move_next_to(&mut self.sample)?;
        if self.chain.push(&mut self.context, sample) {
            Some(Step::Moved)
        } else {
            Some(Step::Skipped)
        }
    }

    /// Returns the estimate at the end of the newest cell; `None` before the first.
    #[must_use]
    pub fn live(&self) -> Option<Live> {
        self.chain.live(&self.context, self.sample()?)
    }

    /// Returns the next finished cell, whose lag is over.
    pub fn next_cell(&mut self) -> Option<Cell> {
        self.chain.next_cell(&mut self.context)
    }

    /// Does a share of the work at the end of a drive, as long as that of [`step`](Self::step).
    /// Returns false when all cells are finished. Fetch them with [`next_cell`](Self::next_cell)
    /// after each share; the last ones are smoothed by less than the full lag. What comes after the
    /// end of a drive starts a new chain of cells.
    pub fn drain_step(&mut self) -> bool {
        self.chain.work(&self.context) || self.chain.begin_end(&mut self.context)
    }

    /// Returns the next of the last cells of a drive. It does all work of
    /// [`drain_step`](Self::drain_step) that the cell needs at once: for callers that are not pressed
    /// for time.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        loop {
            let cell = self.next_cell();
            if cell.is_some() || !self.drain_step() {
                return cell;
            }
        }
    }

    /// Returns the sample of the last step, for a second pass over a whole run on a host.
    #[must_use]
    pub const fn sample(&self) -> Option<&Sample> {
        self.sample.as_ref()
    }

    /// Returns what an earlier drive has left; `None` without one.
    #[must_use]
    pub const fn known(&self) -> Option<&SlowStates> {
        self.chain.known()
    }

    /// Returns whether brakes act that no signal reports, as far as this drive or an earlier one has
    /// found.
    #[must_use]
    pub const fn hides_brakes(&self) -> bool {
        self.chain.window().hides_brakes()
    }

    /// Returns the age of a GNSS fix when it arrives, by which fixes are placed: that which the drive
    /// has shown so far, or the assumed one.
    #[must_use]
    pub fn gnss_latency(&self) -> Duration {
        self.sampler.gnss_latency(self.tuning())
    }

    /// Returns how late receiver, force and altitudes are, as this drive or one before shows.
    #[must_use]
    pub const fn delays(&self) -> Delays {
        Delays {
            altitude: self.chain.altitude_delay(),
            ..self.sampler.delays()
        }
    }

    /// Returns what this drive leaves for the next one. It is `None` before 5 km with GNSS, and if
    /// the state is outside its possible range. It may be taken at any time: its variances say how
    /// much was learned.
    #[must_use]
    pub fn persistent_state(&self) -> Option<PersistentState> {
        let counters = self.counters();
        let is_short = counters.steps < self.tuning().detection.persist_cells;
        if is_short || counters.altitudes_used == 0 {
            return None;
        }
        let slow = self.chain.slow_states(self.sample()?.forces.mass_kg)?;
        let window = self.chain.window();
        PersistentState::new(
            self.fingerprint,
            slow,
            *window.levels(),
            window.hides_brakes(),
            self.delays(),
        )
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
