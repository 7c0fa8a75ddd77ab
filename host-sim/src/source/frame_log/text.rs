//! Logs of lines, whatever their format.

use super::frame_reader::{FrameReader, LogNotes, LoggedFrame};
use super::line_problem::{LineProblem, Parsed};
use crate::error::{Error, Result};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use crate::source::lines::Lines;
use crate::source::log_file::LogFile;
use crate::source::packing::Joint;
use std::collections::VecDeque;

/// The content of a line.
pub(super) enum TextLine {
    /// A blank line.
    Blank,
    /// A header, a comment or an event that is not a frame.
    Other,
    Frame {
        micros: i64,
        interface: InterfaceIndex,
        frame: CanFrame,
        /// True if the line cannot be truncated.
        is_closed: bool,
    },
    /// A message of more than a frame, in the frames that carry it.
    Message {
        micros: i64,
        interface: InterfaceIndex,
        frames: Vec<CanFrame>,
    },
    /// A CAN FD frame.
    FlexibleRate,
    /// A CAN XL frame.
    ExtraLarge,
    BusError,
}

/// A format of lines.
pub(super) trait LineFormat: Send {
    /// Parses the next line of the log, without its end.
    ///
    /// # Errors
    /// Returns what is wrong with the line.
    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine>;

    /// Returns the time of the log's time 0, in microseconds since the Unix epoch, if a line told.
    fn origin_us(&self) -> Option<u64> {
        None
    }
}

/// Reader of the frames of such a log. A log that is cut off ends there.
pub(super) struct TextReader<F> {
    format: F,
    lines: Lines,
    notes: LogNotes,
    /// Grows with damaged lines, and falls with good ones.
    damage_score: u32,
    /// Lines that are no frames.
    other_lines: u64,
    /// Frames of the newest line that were not handed out yet.
    waiting: VecDeque<LoggedFrame>,
}

/// Most lines before the first frame: a log of ASC or TRC may begin with a long list of events.
const MOST_BEFORE_FRAMES: u64 = 1 << 20;

/// What a damaged line adds to the score, and the score of packed data that unpack to nonsense: some
/// ten damaged lines among a hundred.
const DAMAGED: u32 = 10;
const NONSENSE: u32 = 100;

impl<F: LineFormat> TextReader<F> {
    pub(super) fn new(file: LogFile, format: F, is_strict: bool) -> Self {
        file.join(Joint::Lines);
        Self {
            format,
            lines: Lines::new(file),
            notes: LogNotes::new(is_strict),
            damage_score: 0,
            other_lines: 0,
            waiting: VecDeque::new(),
        }
    }

    /// Takes what a line contains; `None` if it is not a frame.
    fn take(&mut self, line: Parsed<TextLine>) -> Result<Option<LoggedFrame>> {
        let is_whole = self.lines.has_end();
        match line {
            Ok(TextLine::Frame {
                micros,
                interface,
                frame,
                is_closed,
            }) if is_whole || is_closed => {
                return Ok(Some(self.notes.frame(micros, interface, frame)));
            }
            Ok(TextLine::Message {
                micros,
                interface,
                frames,
            }) if is_whole => {
                let notes = &mut self.notes;
                let logged = frames
                    .into_iter()
                    .map(|frame| notes.frame(micros, interface, frame));
                self.waiting.extend(logged);
                return Ok(self.waiting.pop_front());
            }
            Err(problem) if problem.is_header && is_whole => {
                return Err(self.wrong_line(&problem));
            }
            // A file without a line end is no log.
            Err(problem) if is_whole || (self.lines.number() == 1 && !problem.is_header) => {
                let error = self.wrong_line(&problem);
                self.notes.damage.line(error, self.notes.frames)?;
            }
            Ok(TextLine::FlexibleRate) if is_whole => self.notes.skipped.can_fd += 1,
            Ok(TextLine::ExtraLarge) if is_whole => self.notes.skipped.can_xl += 1,
            Ok(TextLine::BusError) if is_whole => self.notes.skipped.bus_errors += 1,
            Ok(TextLine::Blank) => {}
            Ok(TextLine::Other) if is_whole => {
                self.other_lines += 1;
                if self.notes.frames == 0 && self.other_lines > MOST_BEFORE_FRAMES {
                    let error = self.error("no frame so far", "a frame among the first lines");
                    return Err(error);
                }
                if self.lines.is_binary() {
                    let problem = format!("binary data in `{}`", self.lines.quote());
                    let error = self.error(&problem, "lines of text");
                    self.notes.damage.line(error, self.notes.frames)?;
                }
            }
            _ => {
                let problem = format!(
                    "the log is cut off within its last line `{}`",
                    self.lines.quote()
                );
                let error = self.error(&problem, "a whole frame and a line end");
                self.notes.damage.cut_off(error)?;
            }
        }
        Ok(None)
    }

    fn wrong_line(&self, problem: &LineProblem) -> Error {
        let what = if self.lines.is_binary() {
            "binary data"
        } else {
            problem.what
        };
        let quote = self.lines.quote();
        self.error(&format!("{what} in `{quote}`"), problem.expected)
    }
}

impl<F: LineFormat> FrameReader for TextReader<F> {
    fn next_logged(&mut self) -> Result<Option<LoggedFrame>> {
        if let Some(waiting) = self.waiting.pop_front() {
            return Ok(Some(waiting));
        }
        while self.lines.advance()? {
            let line = self.lines.line();
            let line = self.format.parse(line, &mut self.notes.interfaces);
            if line.is_err() {
                self.damage_score += DAMAGED;
            } else {
                self.damage_score = self.damage_score.saturating_sub(1);
            }
            if self.damage_score > NONSENSE {
                self.damage_score = 0;
                self.lines.skip_member();
            }
            if let Some(frame) = self.take(line)? {
                return Ok(Some(frame));
            }
        }
        self.notes.origin_us = self.format.origin_us();
        Ok(None)
    }

    fn error(&self, problem: &str, expected: &str) -> Error {
        Error::line(self.file().path(), self.lines.number(), problem, expected)
    }

    fn file(&self) -> &LogFile {
        self.lines.file()
    }

    fn notes(&self) -> &LogNotes {
        &self.notes
    }

    fn notes_mut(&mut self) -> &mut LogNotes {
        &mut self.notes
    }

    fn lines(&self) -> u64 {
        self.lines.number()
    }
}
