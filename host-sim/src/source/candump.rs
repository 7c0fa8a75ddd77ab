//! candump logs: both layouts, plain or gzip, read as a stream.
//!
//! ```text
//! (1.000000) can0 0CF00400#0102030405060708             candump -l, -L
//! (001.000000)  can0  0CF00400   [8]  01 02 03 04 …     candump -t a|z on a terminal
//! ```
//!
//! The parser is our own. It reads both layouts, detects truncated logs, names the line of each
//! error, and reads millions of frames per second without an allocation per line.
//!
//! * Interface names are ignored: frames of all interfaces of a log form one stream.
//! * CAN FD frames and bus error reports of the kernel are skipped and counted in [`Skipped`].
//! * A frame up to 10 ms older than the one before it gets the time of that frame.
//! * A last line without a line end counts only if it cannot be truncated.

use super::can_frame::TimedFrame;
use super::candump_line::{Content, LineProblem, parse};
use super::lines::Lines;
use super::log_file::LogFile;
use super::time_order::{IN_ORDER, TimeOrder};
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use estimator_core::Instant;
use std::path::Path;

/// Number of skipped lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// CAN FD frames: J1939 on classic CAN and NMEA 2000 have none.
    pub can_fd: u64,
    /// Bus errors that the interface reported.
    pub bus_errors: u64,
}

/// Reader of candump logs, frame by frame.
///
/// Times are those of the log, in microseconds; since the Unix epoch if candump logged absolute
/// time.
pub struct CandumpReader {
    lines: Lines,
    order: TimeOrder,
    frames: u64,
    skipped: Skipped,
}

impl CandumpReader {
    /// Opens a log.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self::new(LogFile::open(path)?))
    }

    /// Creates a reader of an open log.
    #[must_use]
    pub fn new(file: LogFile) -> Self {
        Self {
            lines: Lines::new(file),
            order: TimeOrder::default(),
            frames: 0,
            skipped: Skipped::default(),
        }
    }

    /// Reads the next frame; `None` at the end.
    ///
    /// # Errors
    /// Returns an error, with file, line and expected value, for a line that is not candump's, a
    /// truncated last line or gzip stream, time that runs backwards by more than 10 ms, or a file
    /// without frames. Frames returned before such an error are part of a damaged log.
    pub fn next_frame(&mut self) -> Result<Option<TimedFrame>> {
        loop {
            if !self.lines.advance()? {
                return self.end().map(|()| None);
            }
            let line = match parse(self.lines.line()) {
                Ok(Some(line)) if self.lines.has_end() || line.is_closed => line,
                Ok(None) => continue,
                Ok(Some(_)) => return Err(self.cut_off()),
                Err(_) if !self.lines.has_end() && self.frames > 0 => return Err(self.cut_off()),
                Err(problem) => return Err(self.wrong_line(&problem)),
            };
            let logged = Instant::from_micros(line.micros);
            let time = self.order.place(logged);
            let time = time.map_err(|problem| self.error(problem, IN_ORDER))?;
            match line.content {
                Content::Frame(frame) => {
                    self.frames += 1;
                    return Ok(Some(TimedFrame { time, frame }));
                }
                Content::FlexibleRate => self.skipped.can_fd += 1,
                Content::BusError => self.skipped.bus_errors += 1,
            }
        }
    }

    /// Returns the number of lines skipped so far.
    #[must_use]
    pub const fn skipped(&self) -> Skipped {
        self.skipped
    }

    /// Returns the file, for progress and messages.
    #[must_use]
    pub const fn file(&self) -> &LogFile {
        self.lines.file()
    }

    fn end(&self) -> Result<()> {
        if self.frames > 0 {
            return Ok(());
        }
        let Skipped { can_fd, bus_errors } = self.skipped;
        Err(Error::content(
            self.file().path(),
            if can_fd + bus_errors > 0 {
                format!(
                    "no classic CAN frame among {can_fd} CAN FD frames and {bus_errors} bus \
                     errors; expected a candump log of a J1939 bus"
                )
            } else {
                "the file is empty; expected a candump log with at least one frame".to_owned()
            },
        ))
    }

    fn wrong_line(&self, problem: &LineProblem) -> Error {
        let quote = self.lines.quote();
        let what = if self.lines.is_binary() {
            "binary data"
        } else {
            problem.what
        };
        let error = self.error(format!("{what} in `{quote}`"), problem.expected);
        if self.frames > 0 {
            return error;
        }
        // Nothing of a log before it: another file may have taken its place.
        kind::explained(error, self.file().path(), &[Kind::Candump])
    }

    fn cut_off(&self) -> Error {
        let quote = self.lines.quote();
        self.error(
            format!("the log is cut off within its last line `{quote}`"),
            "a whole frame and a line end",
        )
    }

    fn error(&self, problem: String, expected: &str) -> Error {
        Error::line(self.file().path(), self.lines.number(), problem, expected)
    }
}

impl Iterator for CandumpReader {
    type Item = Result<TimedFrame>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_frame().transpose()
    }
}
