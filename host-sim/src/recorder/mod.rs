//! One drive through the core: traffic in, a run out.
//!
//! What grows with the drive is put by in [spools](crate::files::spool), 250 bytes a cell (100 kB/km), so
//! that the memory held does not.

mod long_run;

pub use long_run::{LongRun, Rows, Run};

use crate::error::{Error, Result};
use crate::files::run::RunRow;
use crate::files::spool::{Spool, blocks};
use crate::smooth::{Samples, Smoothed, smooth_stretches};
use crate::source::can_frame::TimedFrame;
use crate::source::input::{Input, for_each_input};
use estimator_core::sampler::Sample;
use estimator_core::{
    Cell, Estimator, Instant, Kept, KeptError, ParameterError, Reading, Scalar, Tuning, Uncertain,
    VehicleParameters,
};
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;
use std::path::Path;

/// Bytes of an entry, with room for numbers of variable length at their longest.
const SAMPLE_SLOT: usize = 128;
const LOOKS_SLOT: usize = 16;

/// What was known of a cell's grade on the way, %.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Looks {
    live: Uncertain,
    lagged: Uncertain,
}

/// Feeds an estimator and keeps what it hands out.
#[derive(Debug)]
pub struct Recorder<S> {
    estimator: Estimator<S>,
    start: Option<Instant>,
    samples: Spool<Sample, SAMPLE_SLOT>,
    looks: Spool<Looks, LOOKS_SLOT>,
    /// The cells that the last input finished.
    new_cells: Vec<Cell>,
    /// The first thing that could not be put by.
    trouble: Option<io::Error>,
}

impl<S: Scalar> Recorder<S> {
    /// A recorder of one drive with this vehicle.
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new(
        vehicle: VehicleParameters,
        tuning: Tuning,
    ) -> std::result::Result<Self, ParameterError> {
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
        self.new_cells.clear();
        while self.estimator.step().is_some() {
            if let Some(sample) = self.estimator.sample() {
                let kept = self.samples.push(sample);
                self.notice(kept);
            }
            while let Some(cell) = self.estimator.next_cell() {
                self.take_cell(cell);
            }
        }
    }

    fn take_cell(&mut self, cell: Cell) {
        let looks = Looks {
            live: cell.live_grade_percent,
            lagged: cell.lagged_grade_percent,
        };
        let kept = self.looks.push(&looks);
        self.notice(kept);
        self.new_cells.push(cell);
    }

    /// Input goes on whatever the disk says; the end tells it.
    fn notice(&mut self, kept: io::Result<()>) {
        if let Err(error) = kept {
            self.trouble.get_or_insert(error);
        }
    }

    /// The cells that the last input finished.
    pub fn new_cells(&self) -> &[Cell] {
        &self.new_cells
    }

    /// Number of cells finished so far.
    pub const fn cells_finished(&self) -> usize {
        self.looks.count()
    }

    /// The state of the estimator.
    pub fn estimator(&self) -> &Estimator<S> {
        &self.estimator
    }

    /// Ends the drive: the last cells, and smoothing over the whole of it.
    ///
    /// # Errors
    /// What the file system says, if the drive was too long for memory.
    pub fn end(mut self) -> Result<LongRun> {
        self.smooth().map_err(no_room)
    }

    /// As [`end`](Self::end), with all rows in memory.
    ///
    /// # Errors
    /// As [`end`](Self::end).
    pub fn finish(self) -> Result<Run> {
        self.end()?.in_memory()
    }

    /// As [`finish`](Self::finish), with what the core sampled for each row.
    ///
    /// # Errors
    /// As [`end`](Self::end).
    pub fn finish_with_samples(mut self) -> Result<(Run, Vec<Sample>)> {
        let run = self.smooth().map_err(no_room)?.in_memory()?;
        // Before the first speed there is a sample and no row.
        let all = self.samples.count();
        let mut samples = Vec::with_capacity(run.rows.len());
        self.samples
            .each(all.saturating_sub(run.rows.len())..all, |sample| {
                samples.push(*sample);
            })
            .map_err(no_room)?;
        Ok((run, samples))
    }

    fn smooth(&mut self) -> io::Result<LongRun> {
        while let Some(cell) = self.estimator.drain_cell() {
            self.take_cell(cell);
        }
        if let Some(trouble) = self.trouble.take() {
            return Err(trouble);
        }
        let start = self.start.unwrap_or_default();
        let mut rows = Rows::default();
        let (samples, looks) = (&mut self.samples, &mut self.looks);
        smooth_stretches(
            self.estimator.vehicle(),
            self.estimator.tuning(),
            &self.estimator.filter_anew::<f64>(),
            samples,
            |first, smoothed| {
                // Both passes begin with the first speed.
                let end = looks.count().min(first + smoothed.len());
                let looks = looks.read(first.min(end)..end)?;
                let stretch = smoothed.iter().zip(&looks);
                let stretch = stretch.map(|(smoothed, looks)| row(start, looks, smoothed));
                rows.put(first, stretch)
            },
        )?;
        Ok(LongRun {
            rows,
            counters: *self.estimator.counters(),
            kept: self.estimator.kept(),
        })
    }
}

impl Samples for Spool<Sample, SAMPLE_SLOT> {
    type Error = io::Error;

    fn count(&self) -> usize {
        Self::count(self)
    }

    fn each(&mut self, part: Range<usize>, mut take: impl FnMut(&Sample)) -> io::Result<()> {
        for block in blocks(part) {
            self.read(block)?.iter().for_each(&mut take);
        }
        Ok(())
    }
}

/// What was put by could not be, or not be had back.
fn no_room(error: io::Error) -> Error {
    Error::io(&std::env::temp_dir())(error)
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
) -> Result<LongRun> {
    let (vehicle, tuning) = (vehicle.clone(), Tuning::default());
    let estimator = match kept {
        Some(kept) => Estimator::<S>::with_kept(vehicle, tuning, kept),
        None => Estimator::new(vehicle, tuning).map_err(KeptError::from),
    };
    let mut recorder = Recorder::from(estimator.map_err(|e| Error::content(log, e.to_string()))?);
    for_each_input(log, progress, |input| recorder.on_input(&input))?;
    recorder.end()
}

impl<S> From<Estimator<S>> for Recorder<S> {
    /// A recorder of the drive that this estimator begins.
    fn from(estimator: Estimator<S>) -> Self {
        Self {
            estimator,
            start: None,
            samples: Spool::default(),
            looks: Spool::default(),
            new_cells: Vec::new(),
            trouble: None,
        }
    }
}

fn row(start: Instant, looks: &Looks, smoothed: &Smoothed) -> RunRow {
    let Smoothed {
        place,
        estimate: smoothed,
    } = smoothed;
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
        lagged_grade_percent: looks.lagged.value.into(),
        lagged_grade_sigma_percent: looks.lagged.sigma.into(),
        live_grade_percent: looks.live.value.into(),
        live_grade_sigma_percent: looks.live.sigma.into(),
        speed_mps: smoothed.speed_mps.into(),
        bias_percent: smoothed.bias_percent.value.into(),
        scale: smoothed.scale.value.into(),
        valid: place.condition.is_valid().into(),
    }
}
