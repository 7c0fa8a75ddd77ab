//! Recordings of a bus, frame by frame, in any format.

mod asc;
mod blf;
mod blf_container;
mod blf_layout;
mod blf_object;
mod busmaster;
mod byte_file;
mod calendar;
mod candump;
mod candump_cursor;
mod candump_line;
mod clx_time;
mod csv_columns;
mod csv_logs;
mod csv_row;
mod fields;
mod frame_reader;
mod interface_arbiter;
mod line_problem;
mod log_clock;
mod mdf;
mod n2k_text;
mod opened;
mod pcap;
mod refusals;
mod rolling_clock;
mod text;
mod trc;
mod whole_message;

pub use frame_reader::Skipped;
pub(super) use frame_reader::{Seconds, moved_to_zero};

use super::can_frame::TimedFrame;
use super::damage::Damage;
use super::interfaces::InterfaceCount;
use super::log_file::LogFile;
use super::log_kind::LogKind;
use super::log_report::LogReport;
use super::mdf::mdf_file::MdfFile;
use super::read_options::ReadOptions;
use super::time_order::TimeOrder;
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::log_format::{LogFormat, format_of};
use crate::files::utc::utc_text;
use estimator_core::Instant;
use frame_reader::{FrameReader, LoggedFrame};
use interface_arbiter::InterfaceArbiter;
use log_clock::{DISORDER_US, IN_ORDER, LogClock, Placed};
use mdf::MdfReader;
use opened::opened;
use std::path::Path;

/// Times after this are those since the Unix epoch: 2001-09-09. A measurement is shorter.
const EPOCH_FROM_US: i64 = 1_000_000_000_000_000;

/// Most frames that wait for earlier ones: with the next one 8 MiB, some minutes of a bus.
const MOST_WAITING: usize = (1 << 18) - 1;
/// What to do with a log whose times begin again.
const RESTARTED: &str = "if the clock was set back within a drive, give --rejoin; if another drive begins \
                         there, cut the log into one for each drive";

/// Reader of a recording of a bus.
///
/// Frames come in the order of time, each message from one interface. Times are those of the log, in
/// microseconds. In the formats of Vector and PEAK they begin with the measurement.
pub struct FrameLog {
    format: LogFormat,
    /// What to say if there is no frame: the first bytes are of no format.
    unknown: Option<String>,
    /// What the file has besides frames, in words.
    beside: Option<String>,
    reader: Box<dyn FrameReader>,
    clock: LogClock,
    order: TimeOrder<LoggedFrame>,
    arbiter: InterfaceArbiter,
    /// Names of the interfaces to read; of all if empty.
    interfaces: Vec<String>,
    selected: u64,
    /// Time of the first frame in the log, µs.
    first_us: Option<i64>,
    is_over: bool,
}

impl FrameLog {
    /// Opens a candump log.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened.
    pub fn open_candump(path: &Path) -> Result<Self> {
        let mut file = LogFile::open(path)?;
        let format = format_of(file.look_at_head());
        Self::new(file, format, &ReadOptions::default())
    }

    /// Creates a reader of an open log; without a format it may be one of candump.
    pub(super) fn new(
        mut file: LogFile,
        format: Option<LogFormat>,
        options: &ReadOptions,
    ) -> Result<Self> {
        let unknown = match format {
            None => refusals::unknown_format(file.look_at_head()),
            Some(_) => None,
        };
        let format = format.unwrap_or(LogFormat::Candump);
        let reader = opened(file, format, options.strict)?;
        Ok(Self::with_reader(format, unknown, reader, options))
    }

    /// Creates a reader of the frames of an MDF file, with what to tell of its other content.
    pub(super) fn of_mdf(
        file: MdfFile,
        beside: Option<String>,
        options: &ReadOptions,
    ) -> Result<Self> {
        let reader = MdfReader::boxed(file, options.strict)?;
        Ok(Self {
            beside,
            ..Self::with_reader(LogFormat::Mdf, None, reader, options)
        })
    }

    fn with_reader(
        format: LogFormat,
        unknown: Option<String>,
        reader: Box<dyn FrameReader>,
        options: &ReadOptions,
    ) -> Self {
        Self {
            format,
            unknown,
            beside: None,
            reader,
            clock: LogClock::new(options.rejoin),
            order: TimeOrder::new(MOST_WAITING),
            arbiter: InterfaceArbiter::default(),
            interfaces: options.interfaces.clone(),
            selected: 0,
            first_us: None,
            is_over: false,
        }
    }

    /// Reads the next frame; `None` at the end.
    ///
    /// # Errors
    /// Returns an error with file, line or byte, and what was expected, for a log with too much
    /// damage, without frames, or without an interface that is asked for. Damage is found on the
    /// way: frames returned before such an error are part of a damaged log.
    pub fn next_frame(&mut self) -> Result<Option<TimedFrame>> {
        loop {
            if let Some(logged) = self.order.next() {
                let notes = self.reader.notes_mut();
                let following = self.order.waiting_until(logged.micros + DISORDER_US);
                if !self.arbiter.admits(&logged, following) {
                    notes.interfaces.count_duplicate(logged.interface);
                    continue;
                }
                return Ok(Some(self.timed(&logged)));
            }
            if self.is_over {
                return Ok(None);
            }
            let logged = match self.reader.next_logged() {
                // Nothing of the log before it.
                Err(error) if self.reader.notes().frames == 0 => {
                    return Err(self.explained(error));
                }
                other => other?,
            };
            match logged {
                Some(logged) => self.place(logged)?,
                None => {
                    self.is_over = true;
                    let last = self.clock.end();
                    last.map_or(Ok(()), |last| self.take(last))?;
                    self.order.end();
                    self.end()?;
                }
            }
        }
    }

    fn place(&mut self, mut logged: LoggedFrame) -> Result<()> {
        if !self.interfaces.is_empty() {
            let name = self.reader.notes().interfaces.name(logged.interface);
            let is_same = |wanted: &String| wanted.eq_ignore_ascii_case(name);
            if !self.interfaces.iter().any(is_same) {
                return Ok(());
            }
        }
        self.selected += 1;
        if self.clock.takes(&mut logged) {
            return self.take(Placed::Taken(logged));
        }
        let reader = &self.reader;
        let error = |problem: &str| reader.error(problem, IN_ORDER);
        let placed = self.clock.place(logged, error);
        placed.into_iter().try_for_each(|placed| self.take(placed))
    }

    fn take(&mut self, placed: Placed) -> Result<()> {
        let problem = match placed {
            Placed::Taken(logged) if self.order.put(logged) => return Ok(()),
            Placed::Taken(logged) => {
                let time = Seconds(logged.micros);
                let problem = format!("{time} stands too far behind later times");
                self.reader.error(&problem, IN_ORDER)
            }
            Placed::LeftOut(problem) => problem,
            Placed::LatestIsWrong(micros, problem) => {
                self.order.forget_latest(micros);
                problem
            }
            Placed::FirstIsWrong(problem) => {
                self.order.clear();
                problem
            }
        };
        let notes = self.reader.notes_mut();
        notes.damage.line(problem, notes.frames)
    }

    /// Returns a frame at its time from that of the first one, if that is negative.
    fn timed(&mut self, logged: &LoggedFrame) -> TimedFrame {
        let first_us = *self.first_us.get_or_insert(logged.micros);
        let micros = logged.micros.saturating_sub(first_us.min(0));
        TimedFrame {
            time: Instant::from_micros(u64::try_from(micros).unwrap_or(0)),
            frame: logged.frame,
        }
    }

    /// Checks the whole log at its end.
    fn end(&mut self) -> Result<()> {
        if self.file().is_cut_off() {
            let error = self.file().cut_off_error();
            self.reader.notes_mut().damage.cut_off(error)?;
        }
        for (problem, bytes) in self.file().packed_damage() {
            self.reader.notes_mut().damage.packed(problem, bytes)?;
        }
        let (lines, bytes) = (self.reader.lines(), self.file().bytes_read());
        let notes = self.reader.notes_mut();
        if notes.frames == 0 {
            return Err(match (notes.damage.take_first(), &self.unknown) {
                (Some(error), _) => self.explained(error),
                (None, Some(unknown)) => {
                    self.explained(Error::content(self.file().path(), unknown))
                }
                (None, None) => self.no_frames(),
            });
        }
        if self.selected == 0 {
            return Err(self.no_interface());
        }
        let is_restarted = 2 * self.clock.too_old() > notes.damage.found().lines;
        notes.damage.end(lines, bytes).map_err(|error| {
            if is_restarted {
                error.with_note(RESTARTED)
            } else {
                error
            }
        })
    }

    /// Returns the error, or one that says that another file may have taken the log's place.
    fn explained(&self, error: Error) -> Error {
        if self.format != LogFormat::Candump {
            return error;
        }
        let path = self.file().path();
        let error = match (&self.unknown, error) {
            (Some(unknown), Error::Line { .. }) => Error::content(path, unknown),
            (_, error) => error,
        };
        kind::explained(error, path, &[Kind::FrameLog(LogFormat::Candump)])
    }

    fn no_frames(&self) -> Error {
        let is_empty = self.file().bytes_read() == 0 || self.format == LogFormat::Candump;
        let problem = refusals::no_frames(self.format, self.skipped(), is_empty);
        Error::content(self.file().path(), problem)
    }

    fn no_interface(&self) -> Error {
        let problem = refusals::no_interface(&self.interfaces, self.interfaces());
        Error::content(self.file().path(), problem)
    }

    /// Returns the number of frames skipped so far.
    #[must_use]
    pub fn skipped(&self) -> Skipped {
        self.reader.notes().skipped
    }

    /// Returns what was left out so far.
    #[must_use]
    pub fn damage(&self) -> &Damage {
        self.reader.notes().damage.found()
    }

    /// Returns the interfaces that had frames so far, in the order of their first ones.
    pub fn interfaces(&self) -> impl Iterator<Item = &InterfaceCount> {
        self.reader.notes().interfaces.counts()
    }

    /// Returns the time of the first frame, in microseconds since the Unix epoch, if the log has it.
    /// Some formats have the time in the time zone of the logger, which they do not tell.
    fn start_unix_micros(&self) -> Option<u64> {
        let first_us = self.first_us?;
        match self.reader.notes().origin_us {
            Some(origin) => origin.checked_add_signed(first_us),
            None if first_us >= EPOCH_FROM_US => u64::try_from(first_us).ok(),
            None => None,
        }
    }

    /// Returns what was mended of the times, in words.
    fn mended(&self) -> Vec<String> {
        let mended = self.clock.mended();
        mended.chain(moved_to_zero(self.first_us)).collect()
    }

    /// Returns what the reading told so far.
    #[must_use]
    pub fn report(&self) -> LogReport {
        LogReport {
            damage: self.damage().clone(),
            interfaces: self.interfaces().cloned().collect(),
            start_utc: self.start_unix_micros().and_then(utc_text),
            mended: self.mended(),
            notes: self.beside.iter().cloned().collect(),
            ..LogReport::default()
        }
    }

    /// Returns the file, for progress and messages.
    #[must_use]
    pub fn file(&self) -> &LogFile {
        self.reader.file()
    }

    /// Returns the kind of the log.
    #[must_use]
    pub const fn kind(&self) -> LogKind {
        LogKind::Frames(self.format)
    }
}

impl Iterator for FrameLog {
    type Item = Result<TimedFrame>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_frame().transpose()
    }
}
