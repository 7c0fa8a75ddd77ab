//! One live drive: received frames become an estimate, a log and counts.

use super::rate::EventRate;
use super::road_view::RoadView;
use super::view::{InterfaceView, LiveView, MemoryView};
use crate::error::{Error, Result};
use crate::files::flash_image::RoadMemoryFile;
use crate::files::output::{Staged, Writing};
use crate::recorder::{LongRun, Recorder};
use crate::source::can_frame::TimedFrame;
use crate::source::candump_writer::write_frame;
use crate::source::frame_readings::FrameReadings;
use crate::source::input::LogInput;
use crate::source::log_time::LogTime;
use crate::source::own_signals::OwnSignals;
use crate::source::read_options::ReadOptions;
use crate::source::socketcan::{BusEvent, Received, ReceivedItem};
use estimator_core::roadmap::{MapLive, PackedMap};
use estimator_core::{Cell, Instant, Live};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant as Monotonic};

/// Time without a frame after which the mode is `silent`.
const SILENCE: Duration = Duration::from_secs(2);

/// Source of the time stamps.
#[derive(Clone, Debug)]
enum Timing {
    /// The kernel's time of reception.
    Kernel,
    /// The time stamp of the replayed log, once one was received.
    Log(Option<Instant>),
}

/// What is to be done about something received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Nothing.
    None,
    /// Report this event to the user.
    Report(BusEvent),
    /// Send this acknowledgement.
    Answer(LogTime),
    /// Send this acknowledgement; the log is over.
    End(LogTime),
}

/// A live drive.
#[derive(Debug)]
pub struct Session {
    recorder: Recorder<f32>,
    readings: FrameReadings,
    /// Finished cells that are not yet fetched.
    cells: Vec<Cell>,
    newest_cell: Option<Cell>,
    timing: Timing,
    interfaces: Vec<(InterfaceView, EventRate)>,
    log: Option<(PathBuf, Writing)>,
    start: Option<Instant>,
    newest: Instant,
    last_frame: Monotonic,
    untimed: u64,
}

impl Session {
    /// Begins a drive on these interfaces. `log` is the file for all frames, as a candump log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be created.
    pub fn begin(
        recorder: Recorder<f32>,
        names: &[String],
        is_log_timed: bool,
        log: Option<&Path>,
    ) -> Result<Self> {
        let now = Monotonic::now();
        let counted = |name: &String| {
            let view = InterfaceView {
                name: name.clone(),
                ..InterfaceView::default()
            };
            (view, EventRate::new(now))
        };
        let log = match log {
            Some(path) => Some((path.to_owned(), Writing::begin(path)?)),
            None => None,
        };
        Ok(Self {
            recorder,
            readings: FrameReadings::default(),
            cells: Vec::new(),
            newest_cell: None,
            timing: if is_log_timed {
                Timing::Log(None)
            } else {
                Timing::Kernel
            },
            interfaces: names.iter().map(counted).collect(),
            log,
            start: None,
            newest: Instant::ZERO,
            last_frame: now,
            untimed: 0,
        })
    }

    /// Takes these signals of the user's own messages too, and from these alone.
    #[must_use]
    pub fn with_own_signals(mut self, own: Option<Arc<OwnSignals>>) -> Self {
        self.readings = FrameReadings::of(own.as_ref());
        self.recorder.read_as(&ReadOptions {
            signals: own,
            ..ReadOptions::default()
        });
        self
    }

    /// Combines the live grade with that of a map.
    #[must_use]
    pub fn with_map(mut self, map: Option<PackedMap<'static>>) -> Self {
        if let Some(map) = map {
            self.recorder.follow(map);
        }
        self
    }

    /// Combines the live grade with the roads that the vehicle knows, and learns this drive.
    #[must_use]
    pub fn with_memory(mut self, memory: Option<RoadMemoryFile>) -> Self {
        if let Some(memory) = memory {
            self.recorder.remember(memory);
        }
        self
    }

    /// Returns the road memory as it is now; `None` without one.
    #[must_use]
    pub const fn memory(&self) -> Option<&RoadMemoryFile> {
        self.recorder.memory()
    }

    /// Processes a received item.
    ///
    /// # Errors
    /// Returns an error if the log cannot be written.
    pub fn take(&mut self, received: &Received) -> Result<Reaction> {
        let (interface, _) = &mut self.interfaces[received.interface];
        match received.item {
            ReceivedItem::Dropped(count) => {
                interface.lost += u64::from(count);
                Ok(Reaction::None)
            }
            ReceivedItem::Event(event) => {
                *interface.events.entry(event).or_default() += 1;
                Ok(Reaction::Report(event))
            }
            ReceivedItem::Frame(frame) => {
                self.last_frame = Monotonic::now();
                let mut time = received.time;
                if let Timing::Log(log_time) = &self.timing {
                    if let Some(message) = LogTime::read(&frame) {
                        return Ok(self.on_log_time(message));
                    }
                    let Some(log_time) = log_time else {
                        self.untimed += 1;
                        return Ok(Reaction::None);
                    };
                    time = *log_time;
                }
                interface.frames += 1;
                self.on_frame(&TimedFrame { time, frame }, received.interface)?;
                Ok(Reaction::None)
            }
        }
    }

    fn on_log_time(&mut self, message: LogTime) -> Reaction {
        let (LogTime::Now(time) | LogTime::Ready(time) | LogTime::End(time)) = message else {
            // The acknowledgement of another listener.
            return Reaction::None;
        };
        self.timing = Timing::Log(Some(time));
        self.start.get_or_insert(time);
        self.recorder.begin(time);
        match message {
            LogTime::Ready(_) => Reaction::Answer(LogTime::Answer(time)),
            LogTime::End(_) => Reaction::End(LogTime::Answer(time)),
            LogTime::Now(_) | LogTime::Answer(_) => Reaction::None,
        }
    }

    fn on_frame(&mut self, frame: &TimedFrame, interface: usize) -> Result<()> {
        self.start.get_or_insert(frame.time);
        self.newest = self.newest.max(frame.time);
        if let Some((path, log)) = &mut self.log {
            let name = &self.interfaces[interface].0.name;
            write_frame(log, frame, name).map_err(Error::io(path))?;
        }
        self.on_input(&LogInput::Frame(*frame));
        let mut found = Vec::new();
        self.readings.decode(frame, |reading| found.push(reading));
        for reading in found {
            self.on_input(&LogInput::Reading(frame.time, reading));
        }
        Ok(())
    }

    fn on_input(&mut self, input: &LogInput) {
        self.recorder.on_input(input);
        let cells = self.recorder.new_cells();
        self.newest_cell = cells.last().copied().or(self.newest_cell);
        self.cells.extend_from_slice(cells);
    }

    /// What the user sees now.
    pub fn view(&mut self, unpublished: Option<u64>) -> LiveView {
        let now = Monotonic::now();
        for (view, rate) in &mut self.interfaces {
            view.frames_per_s = rate.update(now, view.frames);
        }
        let estimator = self.recorder.estimator();
        let start = self.start.unwrap_or(self.newest);
        LiveView {
            time_s: self.newest.since(start).as_secs_f64(),
            live: self.live(),
            memory: self.recorder.memory().map(MemoryView::of),
            road: self.recorder.map().map(|map| {
                let own = estimator.live().map(|live| live.estimate.grade_percent);
                RoadView::of(map, own)
            }),
            is_silent: now.duration_since(self.last_frame) > SILENCE,
            cells_finished: self.recorder.cells_finished(),
            newest_cell_percent: self.newest_cell.map(|cell| {
                let grade = cell.lagged_grade_percent;
                (grade.value, grade.sigma)
            }),
            counters: *estimator.counters(),
            interfaces: self
                .interfaces
                .iter()
                .map(|(view, _)| view.clone())
                .collect(),
            unpublished,
            untimed: self.untimed,
        }
    }

    /// Returns the time since the last frame.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.last_frame.elapsed()
    }

    /// Returns the cells that were finished since the last call.
    #[must_use]
    pub fn fetch_cells(&mut self) -> Vec<Cell> {
        std::mem::take(&mut self.cells)
    }

    /// Ends the drive. Returns the smoothed run and the log, which the caller commits.
    pub fn finish(self) -> (Result<LongRun>, Result<Option<Staged>>) {
        let log = self.log.map(|(_, log)| log.finish()).transpose();
        (self.recorder.end(), log)
    }

    /// Returns the number of finished cells in which signals disagree.
    #[must_use]
    pub fn cells_suspect(&self) -> u32 {
        self.recorder.estimator().counters().cells_suspect
    }

    /// Returns the current estimate, with what is known of the road where that
    /// counts; `None` before the first speed.
    #[must_use]
    pub fn live(&self) -> Option<Live> {
        self.recorder.live()
    }

    /// Returns the place on the map; `None` without a map.
    #[must_use]
    pub const fn map(&self) -> Option<&MapLive<'static>> {
        self.recorder.map()
    }
}
