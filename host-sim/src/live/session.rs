//! One drive, live: what is received becomes an estimate, a log, and counts.

use super::rate::Rate;
use super::view::{InterfaceView, View};
use crate::error::{Error, Result};
use crate::files::output::{Staged, Writing};
use crate::recorder::{LongRun, Recorder};
use crate::source::can_frame::TimedFrame;
use crate::source::candump_writer::write_frame;
use crate::source::log_time::LogTime;
use crate::source::socketcan::{BusEvent, Received, What};
use estimator_core::{Cell, Instant};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant as Monotonic};

/// No frame for so long is worth saying.
const SILENCE: Duration = Duration::from_secs(2);

/// Whose time frames have.
#[derive(Clone, Debug)]
enum Timing {
    /// The kernel's, at which they came.
    Kernel,
    /// The log's that is being replayed, once it was told.
    Log(Option<Instant>),
}

/// What is to be done about something received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Nothing.
    None,
    /// To be told to whoever watches.
    Tell(BusEvent),
    /// To be sent back.
    Answer(LogTime),
    /// To be sent back; the log is over.
    End(LogTime),
}

/// A live drive.
#[derive(Debug)]
pub struct Session {
    recorder: Recorder<f32>,
    /// Finished and not yet fetched.
    cells: Vec<Cell>,
    newest_cell: Option<Cell>,
    timing: Timing,
    interfaces: Vec<(InterfaceView, Rate)>,
    log: Option<(PathBuf, Writing)>,
    start: Option<Instant>,
    newest: Instant,
    heard: Monotonic,
    untimed: u64,
}

impl Session {
    /// Begins a drive on these interfaces. `log` is where all frames go as a candump log.
    ///
    /// # Errors
    /// If the log cannot be begun.
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
            (view, Rate::new(now))
        };
        let log = match log {
            Some(path) => Some((path.to_owned(), Writing::begin(path)?)),
            None => None,
        };
        Ok(Self {
            recorder,
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
            heard: now,
            untimed: 0,
        })
    }

    /// Takes what was received.
    ///
    /// # Errors
    /// If the log cannot be written.
    pub fn take(&mut self, received: &Received) -> Result<Reaction> {
        let (interface, _) = &mut self.interfaces[received.interface];
        match received.what {
            What::Dropped(count) => {
                interface.lost += u64::from(count);
                Ok(Reaction::None)
            }
            What::Event(event) => {
                *interface.events.entry(event).or_default() += 1;
                Ok(Reaction::Tell(event))
            }
            What::Frame(frame) => {
                self.heard = Monotonic::now();
                let mut time = received.time;
                if let Timing::Log(told) = &self.timing {
                    if let Some(message) = LogTime::read(&frame) {
                        return Ok(self.on_log_time(message));
                    }
                    let Some(told) = told else {
                        self.untimed += 1;
                        return Ok(Reaction::None);
                    };
                    time = *told;
                }
                interface.frames += 1;
                self.on_frame(&TimedFrame { time, frame }, received.interface)?;
                Ok(Reaction::None)
            }
        }
    }

    fn on_log_time(&mut self, message: LogTime) -> Reaction {
        let (LogTime::Now(time) | LogTime::Ready(time) | LogTime::End(time)) = message else {
            // That of another listener.
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
        self.recorder.on_frame(frame);
        let cells = self.recorder.new_cells();
        self.newest_cell = cells.last().copied().or(self.newest_cell);
        self.cells.extend_from_slice(cells);
        Ok(())
    }

    /// What there is to see.
    pub fn view(&mut self, unpublished: Option<u64>) -> View {
        let now = Monotonic::now();
        for (view, rate) in &mut self.interfaces {
            view.frames_per_s = rate.update(now, view.frames);
        }
        let estimator = self.recorder.estimator();
        let start = self.start.unwrap_or(self.newest);
        View {
            time_s: self.newest.since(start).micros() as f64 * 1e-6,
            live: estimator.live(),
            is_silent: now.duration_since(self.heard) > SILENCE,
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

    /// How long no frame has come.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.heard.elapsed()
    }

    /// The cells that were finished since they were last fetched.
    #[must_use]
    pub fn fetch_cells(&mut self) -> Vec<Cell> {
        std::mem::take(&mut self.cells)
    }

    /// Ends the drive; the log, if there is one and it could be ended, is to be committed.
    pub fn finish(self) -> (Result<LongRun>, Result<Option<Staged>>) {
        let log = self.log.map(|(_, log)| log.finish()).transpose();
        (self.recorder.end(), log)
    }

    /// The estimate now.
    #[must_use]
    pub fn live(&self) -> Option<estimator_core::Live> {
        self.recorder.estimator().live()
    }
}
