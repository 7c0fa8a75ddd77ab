//! One drive through the core: traffic in, a run out.

use crate::error::Error;
use crate::run_file::RunRow;
use crate::smooth::{Smoothed, smooth_run};
use crate::source::can_frame::TimedFrame;
use crate::source::input::{Input, for_each_input};
use estimator_core::sampler::Sample;
use estimator_core::{
    Cell, Counters, Estimator, Instant, Kept, KeptError, ParameterError, Reading, Scalar, Tuning,
    VehicleParameters,
};
use std::path::Path;

/// Feeds an estimator and keeps what it hands out.
#[derive(Debug)]
pub struct Recorder<S> {
    estimator: Estimator<S>,
    start: Option<Instant>,
    samples: Vec<Sample>,
    cells: Vec<Cell>,
}

/// A whole drive, smoothed.
#[derive(Debug)]
pub struct Run {
    /// Its cells.
    pub rows: Vec<RunRow>,
    /// What happened on the way.
    pub counters: Counters,
    /// What it leaves for the next drive, if it was long enough.
    pub kept: Option<Kept>,
}

impl<S: Scalar> Recorder<S> {
    /// A recorder of one drive with this vehicle.
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new(vehicle: VehicleParameters, tuning: Tuning) -> Result<Self, ParameterError> {
        Estimator::new(vehicle, tuning).map(Self::from)
    }

    /// Tells when the drive began, if before the first input that comes here: `time_s` counts from
    /// the first frame on the bus, wanted or not.
    pub fn begin(&mut self, start: Instant) {
        self.start.get_or_insert(start);
    }

    /// Takes one frame.
    pub fn on_frame(&mut self, timed: &TimedFrame) {
        self.start.get_or_insert(timed.time);
        self.estimator.on_frame(timed.time, &timed.frame);
        self.collect();
    }

    /// Takes one reading of a signal table.
    pub fn on_reading(&mut self, time: Instant, reading: Reading) {
        self.start.get_or_insert(time);
        self.estimator.on_reading(time, reading);
        self.collect();
    }

    /// Takes one input of a log.
    pub fn on_input(&mut self, input: &Input) {
        match input {
            Input::Frame(frame) => self.on_frame(frame),
            Input::Reading(time, reading) => self.on_reading(*time, *reading),
        }
    }

    fn collect(&mut self) {
        while self.estimator.step().is_some() {
            self.samples.extend(self.estimator.sample().copied());
            while let Some(cell) = self.estimator.next_cell() {
                self.cells.push(cell);
            }
        }
    }

    /// The cells finished so far.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The state of the estimator.
    pub fn estimator(&self) -> &Estimator<S> {
        &self.estimator
    }

    /// Ends the drive: the last cells, and smoothing over the whole of it.
    #[must_use]
    pub fn finish(self) -> Run {
        self.finish_with_samples().0
    }

    /// As [`finish`](Self::finish), with what the core sampled for each row.
    #[must_use]
    pub fn finish_with_samples(mut self) -> (Run, Vec<Sample>) {
        while let Some(cell) = self.estimator.drain_cell() {
            self.cells.push(cell);
        }
        let start = self.start.unwrap_or_default();
        let smoothed = smooth_run(
            self.estimator.vehicle(),
            self.estimator.tuning(),
            &self.estimator.filter_anew::<f64>(),
            &self.samples,
        );
        let rows: Vec<RunRow> = smoothed
            .iter()
            .zip(&self.cells)
            .map(|(smoothed, cell)| row(start, cell, smoothed))
            .collect();
        let run = Run {
            counters: *self.estimator.counters(),
            kept: self.estimator.kept(),
            rows,
        };
        // Before the first speed there is a sample and no row.
        let without_row = self.samples.len().saturating_sub(run.rows.len());
        self.samples.drain(..without_row);
        (run, self.samples)
    }
}

/// Feeds a whole log of either kind to an estimator that begins with what the last drive left, if
/// anything. `progress` is told the bytes read so far, now and then.
///
/// # Errors
/// An impossible vehicle, or not that of the last drive; a log that cannot be read to its end, with
/// file and line.
pub fn estimate_log<S: Scalar>(
    vehicle: &VehicleParameters,
    kept: Option<&Kept>,
    log: &Path,
    progress: impl Fn(u64),
) -> Result<Run, Error> {
    let (vehicle, tuning) = (vehicle.clone(), Tuning::default());
    let estimator = match kept {
        Some(kept) => Estimator::<S>::with_kept(vehicle, tuning, kept),
        None => Estimator::new(vehicle, tuning).map_err(KeptError::from),
    };
    let mut recorder = Recorder::from(estimator.map_err(|e| Error::content(log, e.to_string()))?);
    for_each_input(log, progress, |input| recorder.on_input(&input))?;
    Ok(recorder.finish())
}

impl<S> From<Estimator<S>> for Recorder<S> {
    /// A recorder of the drive that this estimator begins.
    fn from(estimator: Estimator<S>) -> Self {
        Self {
            estimator,
            start: None,
            samples: Vec::new(),
            cells: Vec::new(),
        }
    }
}

fn row(start: Instant, cell: &Cell, smoothed: &Smoothed) -> RunRow {
    let Smoothed {
        place,
        estimate: smoothed,
    } = smoothed;
    debug_assert_eq!(place, &cell.place, "both passes begin with the first speed");
    let degrees = |e7: i32| f64::from(e7) * 1e-7;
    RunRow {
        time_s: place.time.since(start).micros() as f64 * 1e-6,
        distance_m: place.distance_m(),
        latitude_deg: place.position_e7.map(|(latitude, _)| degrees(latitude)),
        longitude_deg: place.position_e7.map(|(_, longitude)| degrees(longitude)),
        altitude_m: smoothed.altitude_m.map(|z| z.value.into()),
        altitude_sigma_m: smoothed.altitude_m.map(|z| z.sigma.into()),
        grade_percent: smoothed.grade_percent.value.into(),
        grade_sigma_percent: smoothed.grade_percent.sigma.into(),
        lagged_grade_percent: cell.lagged_grade_percent.value.into(),
        lagged_grade_sigma_percent: cell.lagged_grade_percent.sigma.into(),
        live_grade_percent: cell.live_grade_percent.value.into(),
        live_grade_sigma_percent: cell.live_grade_percent.sigma.into(),
        speed_mps: smoothed.speed_mps.into(),
        bias_percent: smoothed.bias_percent.value.into(),
        scale: smoothed.scale.value.into(),
        valid: place.condition.is_valid().into(),
    }
}
