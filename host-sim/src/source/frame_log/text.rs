//! Logs of lines, whatever their format.

use crate::error::{Error, Result};
use crate::source::can_frame::{CanFrame, TimedFrame};
use crate::source::candump::Skipped;
use crate::source::candump_line::{LineProblem, Parsed};
use crate::source::lines::Lines;
use crate::source::log_file::LogFile;
use crate::source::time_order::{IN_ORDER, TimeOrder};
use estimator_core::Instant;

/// The content of a line.
pub(super) enum TextLine {
    /// A header, a comment or an event that is not a frame.
    Other,
    Frame {
        micros: u64,
        frame: CanFrame,
        /// True if the line cannot be truncated.
        is_closed: bool,
    },
    /// A CAN FD frame.
    FlexibleRate,
    BusError,
}

/// A format of lines.
pub(super) trait LineFormat {
    /// Name for messages, with its article.
    const NAME: &'static str;

    /// Parses the next line of the log, without its end.
    ///
    /// # Errors
    /// Returns what is wrong with the line.
    fn parse(&mut self, line: &[u8]) -> Parsed<TextLine>;
}

/// Reader of the frames of such a log. A log that is cut off ends there.
pub(super) struct TextReader<F> {
    format: F,
    lines: Lines,
    order: TimeOrder,
    frames: u64,
    skipped: Skipped,
}

impl<F: LineFormat> TextReader<F> {
    pub(super) fn new(mut file: LogFile, format: F) -> Self {
        file.allow_cut_off();
        Self {
            format,
            lines: Lines::new(file),
            order: TimeOrder::default(),
            frames: 0,
            skipped: Skipped::default(),
        }
    }

    pub(super) fn next_frame(&mut self) -> Result<Option<TimedFrame>> {
        while self.lines.advance()? {
            let is_whole = self.lines.has_end();
            match self.format.parse(self.lines.line()) {
                Ok(TextLine::Frame {
                    micros,
                    frame,
                    is_closed,
                }) if is_whole || is_closed => {
                    let time = self.order.place(Instant::from_micros(micros));
                    let time = time.map_err(|problem| self.error(problem, IN_ORDER))?;
                    self.frames += 1;
                    return Ok(Some(TimedFrame { time, frame }));
                }
                Err(problem) if is_whole => return Err(self.wrong_line(&problem)),
                Ok(TextLine::FlexibleRate) if is_whole => self.skipped.can_fd += 1,
                Ok(TextLine::BusError) if is_whole => self.skipped.bus_errors += 1,
                Ok(TextLine::Other) if is_whole && self.lines.is_binary() => {
                    return Err(self.error(
                        format!("binary data in `{}`", self.lines.quote()),
                        "lines of text",
                    ));
                }
                // The rest is the last line of a log that is cut off.
                _ => {}
            }
        }
        no_frames(self.file(), self.frames, self.skipped, F::NAME).map(|()| None)
    }

    pub(super) const fn skipped(&self) -> Skipped {
        self.skipped
    }

    pub(super) const fn file(&self) -> &LogFile {
        self.lines.file()
    }

    fn wrong_line(&self, problem: &LineProblem) -> Error {
        let what = if self.lines.is_binary() {
            "binary data"
        } else {
            problem.what
        };
        let quote = self.lines.quote();
        self.error(format!("{what} in `{quote}`"), problem.expected)
    }

    fn error(&self, problem: String, expected: &str) -> Error {
        Error::line(self.file().path(), self.lines.number(), problem, expected)
    }
}

/// Returns an error if a log ended without a frame.
pub(super) fn no_frames(file: &LogFile, frames: u64, skipped: Skipped, name: &str) -> Result<()> {
    if frames > 0 {
        return Ok(());
    }
    let Skipped { can_fd, bus_errors } = skipped;
    let problem = if can_fd.saturating_add(bus_errors) > 0 {
        format!(
            "no classic CAN frame among {can_fd} CAN FD frames and {bus_errors} bus errors; \
             expected {name} of a J1939 bus"
        )
    } else {
        format!("no frames; expected {name} with at least one frame")
    };
    Err(Error::content(file.path(), problem))
}
