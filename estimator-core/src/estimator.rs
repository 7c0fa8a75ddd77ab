//! The facade: frames and timestamps in, cells and a live estimate out.

use crate::cell::{Cell, Estimate, Place};
use crate::counters::Counters;
use crate::filter::{AltitudeEvent, Filter, SensorNoise, SlowStates};
use crate::intake::{Desk, Intake, Outcome};
use crate::kept::{Kept, KeptError};
use crate::lag::Lag;
use crate::sampler::Sample;
use crate::scalar::Scalar;
use crate::signal::Reading;
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{ParameterError, VehicleParameters};
use embedded_can::Frame;

/// Cells driven and altitudes used before a drive leaves anything: 5 km, with GNSS on some of it.
/// How much they told is in the variances; what is kept is just not worth a write before.
const LEAST_STEPS: u32 = 2_000;
const LEAST_ALTITUDES: u32 = 100;

/// The estimate now.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Live {
    /// The end of the newest cell.
    pub place: Place,
    /// What is known there.
    pub estimate: Estimate,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// The filter moved over a cell; and what became of an altitude there, if more than that it
    /// was used.
    Moved(Option<AltitudeEvent>),
    /// A cell without an estimate: no speed was read yet, or the filter was started anew.
    Skipped,
}

/// A grade estimator for one vehicle.
///
/// Sans-I/O: feed it with [`on_frame`](Self::on_frame) (or [`on_reading`](Self::on_reading)
/// where there is no bus), let it work with [`step`](Self::step), fetch results with
/// [`live`](Self::live) and [`next_cell`](Self::next_cell). It never allocates, blocks or reads
/// a clock; all input is checked and what is unusable is counted in
/// [`counters`](Self::counters).
///
/// ```
/// use estimator_core::{Effects, Estimator, Tuning, VehicleParameters, Traction};
/// # use estimator_core::{Instant, Reading, Signal, Value};
/// let vehicle = VehicleParameters {
///     mass_kg: 19_000.0,
///     drag_area_m2: 5.2,
///     rolling_resistance: 0.008,
///     wheel_radius_m: 0.48,
///     wheel_inertia_kgm2: 60.0,
///     traction: Traction::Force,
///     effects: Effects::default(),
/// };
/// let mut estimator = Estimator::<f32>::new(vehicle, Tuning::default())?;
/// # for second in 0..60 {
/// #     let now = Instant::from_micros(second * 1_000_000);
/// #     for (signal, value) in [(Signal::TractionForce, 2_000.0), (Signal::WheelSpeed, 10.0)] {
/// #         estimator.on_reading(now, Reading { signal, value: Value::Real(value) });
/// #     }
/// while estimator.step().is_some() {}
/// while let Some(cell) = estimator.next_cell() {
///     println!("{:.1} m {:.2} %", cell.place.distance_m(), cell.lagged_grade_percent.value);
/// }
/// # }
/// # assert!(estimator.live().is_some());
/// # Ok::<(), estimator_core::ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Estimator<S> {
    intake: Intake,
    filter: Filter<S>,
    lag: Lag<S>,
    place: Place,
    sample: Option<Sample>,
}

impl<S: Scalar> Estimator<S> {
    /// An estimator for this vehicle.
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new(vehicle: VehicleParameters, tuning: Tuning) -> Result<Self, ParameterError> {
        Ok(Self {
            intake: Intake::new(vehicle, tuning)?,
            filter: Filter::new(),
            lag: Lag::new(),
            place: Place::default(),
            sample: None,
        })
    }

    /// An estimator for this vehicle that begins with what an earlier drive left.
    ///
    /// # Errors
    /// [`KeptError::Parameter`] for a parameter that no vehicle can have, [`KeptError::Vehicle`]
    /// if it was another vehicle, or other parameters, that the drive was estimated with.
    pub fn with_kept(
        vehicle: VehicleParameters,
        tuning: Tuning,
        kept: &Kept,
    ) -> Result<Self, KeptError> {
        let mut estimator = Self::new(vehicle, tuning)?;
        kept.check_vehicle(estimator.vehicle())?;
        let noise = kept.noise(estimator.tuning());
        estimator.filter = Filter::with_known(&noise, Some(*kept.slow_states()));
        Ok(estimator)
    }

    /// Takes one frame, received at `now`.
    pub fn on_frame<F: Frame>(&mut self, now: Instant, frame: &F) -> Outcome {
        self.intake.on_frame(now, frame)
    }

    /// Takes one reading that came without a bus. Simultaneous readings go in the order of
    /// [`Signal`](crate::Signal).
    pub fn on_reading(&mut self, now: Instant, reading: Reading) -> Outcome {
        self.intake.on_reading(now, reading)
    }

    /// Moves the filter over one cell; `None` if none is ready. Call it until it says so.
    pub fn step(&mut self) -> Option<Step> {
        let sample = self.sample.insert(self.intake.next_sample()?);
        let Desk {
            vehicle,
            tuning,
            counters,
            ..
        } = &mut self.intake.desk;
        let moved = self.filter.advance(vehicle, tuning, sample, counters);
        let (Some(moved), Some(state)) = (moved, self.filter.state()) else {
            return Some(Step::Skipped);
        };
        self.place = moved.place;
        let lost = self.lag.push(&moved, state) as u32;
        counters.cells_lost = counters.cells_lost.saturating_add(lost);
        Some(Step::Moved(moved.event))
    }

    /// The estimate at the end of the newest cell; `None` before the first.
    #[must_use]
    pub fn live(&self) -> Option<Live> {
        self.filter.state().map(|state| Live {
            place: self.place,
            estimate: state.estimate(),
        })
    }

    /// The next cell whose lag is over.
    pub fn next_cell(&mut self) -> Option<Cell> {
        let cell = self.lag.next_cell();
        self.judged(cell)
    }

    /// The next of the last cells of a drive, which have seen less than the full lag. For the
    /// end of a drive: what comes after it starts a new chain of cells.
    pub fn drain_cell(&mut self) -> Option<Cell> {
        let cell = self.lag.drain_cell();
        self.judged(cell)
    }

    /// The cell, counted if its numbers are none: where a scalar is too narrow for the smoothing.
    fn judged(&mut self, cell: Option<Cell>) -> Option<Cell> {
        if let Some(cell) = &cell
            && !(cell.lagged_grade_percent.value + cell.lagged_grade_percent.sigma).is_finite()
        {
            let unsound = &mut self.intake.desk.counters.cells_unsound;
            *unsound = unsound.saturating_add(1);
        }
        cell
    }

    /// What the last step saw, for going over a whole run again on a host.
    #[must_use]
    pub const fn sample(&self) -> Option<&Sample> {
        self.sample.as_ref()
    }

    /// What this drive leaves for the next one; `None` before 5 km with GNSS, or if its state is
    /// out of all reason. It may be taken at any time: the next drive knows how sure it was.
    #[must_use]
    pub fn kept(&self) -> Option<Kept> {
        let counters = self.counters();
        if counters.steps < LEAST_STEPS || counters.altitudes_used < LEAST_ALTITUDES {
            return None;
        }
        let slow = SlowStates::of(self.filter.state()?, self.sample()?.load.mass_kg);
        Kept::new(self.vehicle(), self.tuning(), slow, &self.noise())
    }

    /// A filter that begins as this estimator's did, with what it has learned of the sensors'
    /// noise since: for going over a whole run again on a host.
    #[must_use]
    pub fn filter_anew<T: Scalar>(&self) -> Filter<T> {
        self.filter.anew()
    }

    /// What has been learned of the sensors' noise.
    #[must_use]
    pub const fn noise(&self) -> SensorNoise {
        self.filter.noise()
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        self.intake.counters()
    }

    /// The tuning as given.
    #[must_use]
    pub const fn tuning(&self) -> &Tuning {
        self.intake.tuning()
    }

    /// The vehicle as given.
    #[must_use]
    pub const fn vehicle(&self) -> &VehicleParameters {
        self.intake.vehicle()
    }
}
