//! Runs the estimator over one drive and stores its output.

use super::innovations::Innovations;
use super::long_run::{LongRun, Rows, SmoothedRun};
use super::placed_samples::PlacedSamples;
use super::plausibility::Plausibility;
use super::roads::Roads;
use super::roadway_grade::RoadwayGrade;
use crate::error::Result;
use crate::files::flash_image::RoadMemoryFile;
use crate::files::run::RunRow;
use crate::files::spool::{Spool, no_room};
use crate::files::utc::utc_of;
use crate::smooth::{Known, MeasurementSink, Samples, SmoothedCell, smooth_pieces};
use crate::source::can_frame::TimedFrame;
use crate::source::input::LogInput;
use crate::source::log_report::LogReport;
use crate::source::read_options::ReadOptions;
use estimator_core::roadmap::{MapLive, PackedMap};
use estimator_core::sample::Sample;
use estimator_core::{
    Cell, Estimator, Instant, Live, Model, Outcome, ParameterError, PersistentState,
    PersistentStateError, Reading, Scalar, Signal, Step, Tuning, Uncertain,
};
use serde::{Deserialize, Serialize};
use std::io;

/// Slot size of the grades, bytes.
const GRADES_SLOT: usize = 18;
/// Grades of a cell that were available during the drive, %, and whether nothing disagreed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct OnlineGrades {
    live: Uncertain,
    lagged: Uncertain,
    live_consistent: bool,
    lagged_consistent: bool,
}

/// Runs the estimator over one drive and stores its output.
#[derive(Debug)]
pub struct Recorder<S> {
    /// Not in place: recorders are moved, and threads have small stacks.
    estimator: Box<Estimator<S>>,
    start: Option<Instant>,
    samples: PlacedSamples,
    grades: Spool<OnlineGrades, GRADES_SLOT>,
    roads: Roads,
    /// Measurements beside what the filter predicted, if they are wanted.
    innovations: Option<Innovations>,
    plausibility: Plausibility,
    roadway_grade: RoadwayGrade,
    /// The cells that the last input finished.
    new_cells: Vec<Cell>,
    /// The error of the first sample or cell that could not be stored.
    trouble: Option<io::Error>,
}

impl<S: Scalar> Recorder<S> {
    /// Creates a recorder of one drive with this vehicle.
    ///
    /// # Errors
    /// Returns the first parameter that is out of range.
    pub fn new(
        model: impl Into<Model>,
        tuning: Tuning,
    ) -> std::result::Result<Self, ParameterError> {
        Estimator::new(model, tuning).map(Self::from)
    }

    /// Creates a recorder of one drive that starts from the persistent state of the last one, if
    /// there is any.
    ///
    /// # Errors
    /// Returns an error for a parameter that is out of range and for the state of another vehicle.
    pub fn resume(
        model: &Model,
        tuning: &Tuning,
        persistent_state: Option<&PersistentState>,
    ) -> std::result::Result<Self, PersistentStateError> {
        let (model, tuning) = (model.clone(), tuning.clone());
        let estimator = match persistent_state {
            Some(persistent_state) => Estimator::restore(model, tuning, persistent_state)?,
            None => Estimator::new(model, tuning)?,
        };
        Ok(Self::from(estimator))
    }

    /// Sets the start of the drive, if it is before the first input: `time_s` counts from the first
    /// frame on the bus, whether it is decoded or not.
    pub fn begin(&mut self, start: Instant) {
        self.start.get_or_insert(start);
    }

    /// Takes the inputs of a log that is read so: leaves out signals, and takes those of own messages
    /// from these alone.
    pub fn read_as(&mut self, options: &ReadOptions) {
        self.ignore(&options.ignore);
        if let Some(own) = &options.signals {
            for signal in own.signals() {
                self.estimator.reserve(signal);
                self.plausibility.reserve(signal);
            }
        }
    }

    /// Leaves out signals, as if the bus did not have them.
    pub fn ignore(&mut self, signals: &[Signal]) {
        for signal in signals {
            self.estimator.ignore(*signal);
            self.plausibility.ignore(*signal);
        }
    }

    /// Combines the live grade with that of a map from now on.
    pub fn follow(&mut self, map: PackedMap<'static>) {
        self.roads.follow(map);
    }

    /// Learns roads from now on, and combines the live grade with what the memory knows.
    pub fn remember(&mut self, memory: RoadMemoryFile) {
        self.roads.memory = Some(memory);
    }

    /// Keeps the measurements of the drive beside what the filter predicted.
    pub fn keep_innovations(&mut self) {
        self.innovations = Some(Innovations::default());
    }

    /// Returns the place on the map and the grade with it; `None` without a map.
    pub const fn map(&self) -> Option<&MapLive<'static>> {
        self.roads.map.as_ref()
    }

    /// Returns the road memory; `None` without one.
    pub const fn memory(&self) -> Option<&RoadMemoryFile> {
        self.roads.memory.as_ref()
    }

    /// Returns the live estimate, with what is known of the road where that counts; `None` before the
    /// first speed.
    pub fn live(&self) -> Option<Live> {
        let live = self.estimator.live()?;
        Some(self.roads.applied(&live))
    }

    /// Takes one frame.
    pub fn on_frame(&mut self, timed: &TimedFrame) {
        self.start.get_or_insert(timed.time);
        let estimator = &self.estimator;
        self.roadway_grade.frame(&timed.frame, || estimator.live());
        self.estimator.on_frame(timed.time, &timed.frame);
        let (vehicle, tuning) = (&self.estimator.model().vehicle, self.estimator.tuning());
        self.plausibility
            .frame(timed.time, &timed.frame, vehicle, tuning);
        self.collect();
    }

    /// Processes one reading of a signal table.
    pub fn on_reading(&mut self, time: Instant, reading: Reading) {
        self.start.get_or_insert(time);
        let estimator = &self.estimator;
        self.roadway_grade.reading(reading, || estimator.live());
        // A signal that is left out is not judged either.
        if self.estimator.on_reading(time, reading) != Outcome::Ignored {
            let vehicle = &self.estimator.model().vehicle;
            self.plausibility.reading(time, reading, vehicle);
        }
        self.collect();
    }

    /// Processes one input of a log.
    pub fn on_input(&mut self, input: &LogInput) {
        match input {
            LogInput::Frame(frame) => self.on_frame(frame),
            LogInput::Reading(time, reading) => self.on_reading(*time, *reading),
        }
    }

    fn collect(&mut self) {
        self.new_cells.clear();
        while let Some(step) = self.estimator.step() {
            if step == Step::Moved {
                self.advance_map();
            }
            if step != Step::Smoothed {
                self.take_sample();
            }
            while let Some(cell) = self.estimator.next_cell() {
                self.take_cell(cell);
            }
        }
    }

    fn take_sample(&mut self) {
        let Some(sample) = self.estimator.sample() else {
            return;
        };
        let latency = self.estimator.gnss_latency();
        let vehicle = &self.estimator.model().vehicle;
        self.plausibility.sample(sample, vehicle);
        let kept = self.samples.push(sample, latency);
        self.note_failure(kept);
    }

    fn advance_map(&mut self) {
        if let Some(live) = self.estimator.live() {
            let kept = self.roads.advance(&live);
            self.note_failure(kept);
        }
    }

    fn take_cell(&mut self, cell: Cell) {
        let learned = self.roads.finish(&cell);
        self.note_failure(learned);
        let grades = OnlineGrades {
            live: cell.live_grade_percent,
            lagged: cell.lagged_grade_percent,
            live_consistent: cell.live_consistent,
            lagged_consistent: cell.lagged_consistent,
        };
        let kept = self.grades.push(&grades);
        self.note_failure(kept);
        self.new_cells.push(cell);
    }

    /// Stores the first error of the disk. Processing goes on; [`end`](Self::end) returns the
    /// error.
    fn note_failure(&mut self, stored: io::Result<()>) {
        if let Err(error) = stored {
            self.trouble.get_or_insert(error);
        }
    }

    /// Returns the cells that the last input finished.
    pub fn new_cells(&self) -> &[Cell] {
        &self.new_cells
    }

    /// Returns the number of finished cells.
    pub const fn cells_finished(&self) -> usize {
        self.grades.count()
    }

    /// Returns the estimator.
    pub fn estimator(&self) -> &Estimator<S> {
        &self.estimator
    }

    /// Ends the drive and smooths the whole run.
    ///
    /// # Errors
    /// Returns the error of the file system, if the drive was too long for memory.
    pub fn end(mut self) -> Result<LongRun> {
        let mut run = self.smooth().map_err(no_room)?;
        run.memory = self.roads.end().map_err(no_room)?;
        Ok(run)
    }

    /// Ends the drive as [`end`](Self::end) does, with all rows in memory.
    ///
    /// # Errors
    /// Returns the errors of [`end`](Self::end).
    pub fn finish(self) -> Result<SmoothedRun> {
        self.end()?.in_memory()
    }

    /// Ends the drive as [`finish`](Self::finish) does, and returns the sample of each row.
    ///
    /// # Errors
    /// Returns the errors of [`end`](Self::end).
    pub fn finish_with_samples(mut self) -> Result<(SmoothedRun, Vec<Sample>)> {
        let run = self.smooth().map_err(no_room)?.in_memory()?;
        // Before the first speed there are samples without rows.
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
        let (samples, grades) = (&mut self.samples, &mut self.grades);
        let roads = &mut self.roads;
        let plausibility = &mut self.plausibility;
        let put = |first: usize, smoothed: Vec<SmoothedCell>| {
            // Both passes begin with the first speed.
            let end = grades.count().min(first + smoothed.len());
            let grades = grades.read(first.min(end)..end)?;
            let with_roads = roads.read(first.min(end)..end)?;
            let cells = smoothed.iter().inspect(|cell| plausibility.smoothed(cell));
            let segment = cells.zip(&grades).zip(with_roads);
            let segment = segment.map(|((smoothed, grades), with_roads)| {
                let row = row(start, grades, smoothed);
                with_roads.map_or(row, |with_roads| with_roads.applied(row))
            });
            rows.put(first, segment)
        };
        let estimator = &self.estimator;
        let known = Known {
            slow_states: estimator.known(),
            hides_brakes: estimator.hides_brakes(),
            altitude_delay: Some(estimator.delays().altitude),
        };
        let mut innovations = self.innovations.take();
        let mut sink = innovations.as_mut().map(|kept| kept.sink(start));
        let measured = sink
            .as_mut()
            .map(|sink| sink as &mut MeasurementSink<'_, _>);
        let context = estimator.context();
        let disagreements = smooth_pieces(context, known, samples, measured, put)?;
        drop(sink);
        Ok(LongRun {
            rows,
            model: self.estimator.model().clone(),
            log: LogReport::default(),
            counters: *self.estimator.counters(),
            delays: self.estimator.delays(),
            persistent_state: self.estimator.persistent_state(),
            disagreements,
            start_utc: self.start.and_then(utc_of),
            map: self.roads.map.as_ref().map(|map| *map.counters()),
            memory: None,
            innovations,
            roadway_grade: self.roadway_grade.comparison(),
            warnings: self.plausibility.judge(&self.estimator.model().vehicle),
        })
    }
}

impl<S> From<Estimator<S>> for Recorder<S> {
    /// Creates a recorder of the drive that this estimator begins.
    fn from(estimator: Estimator<S>) -> Self {
        Self {
            estimator: Box::new(estimator),
            start: None,
            samples: PlacedSamples::default(),
            grades: Spool::default(),
            roads: Roads::default(),
            innovations: None,
            plausibility: Plausibility::default(),
            roadway_grade: RoadwayGrade::default(),
            new_cells: Vec::new(),
            trouble: None,
        }
    }
}

fn row(start: Instant, grades: &OnlineGrades, smoothed: &SmoothedCell) -> RunRow {
    let SmoothedCell {
        end,
        estimate: smoothed,
        is_consistent,
    } = smoothed;
    let degrees = |e7: i32| f64::from(e7) * 1e-7;
    RunRow {
        time_s: end.time.since(start).as_secs_f64(),
        distance_m: end.distance_m(),
        latitude_deg: end.position_e7.map(|(latitude, _)| degrees(latitude)),
        longitude_deg: end.position_e7.map(|(_, longitude)| degrees(longitude)),
        altitude_m: smoothed.altitude_m.map(|z| z.value.into()),
        altitude_sigma_m: smoothed.altitude_m.map(|z| z.sigma.into()),
        grade_percent: smoothed.grade_percent.value.into(),
        grade_sigma_percent: smoothed.grade_percent.sigma.into(),
        lagged_grade_percent: grades.lagged.value.into(),
        lagged_grade_sigma_percent: grades.lagged.sigma.into(),
        live_grade_percent: grades.live.value.into(),
        live_grade_sigma_percent: grades.live.sigma.into(),
        speed_mps: smoothed.speed_mps.into(),
        bias_percent: smoothed.bias_percent.value.into(),
        scale: smoothed.scale.value.into(),
        valid: end.condition.is_valid().into(),
        mass_kg: Some(smoothed.mass_kg.value.into()),
        mass_sigma_kg: Some(smoothed.mass_kg.sigma.into()),
        consistent: (*is_consistent).into(),
        lagged_consistent: grades.lagged_consistent.into(),
        live_consistent: grades.live_consistent.into(),
        map_grade_percent: None,
        map_grade_sigma_percent: None,
    }
}
