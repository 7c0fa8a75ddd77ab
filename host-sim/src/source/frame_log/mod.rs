//! Recordings of a bus, frame by frame, in any format.

mod asc;
mod blf;
mod blf_container;
mod blf_object;
mod fields;
mod text;
mod trc;

use super::can_frame::TimedFrame;
use super::candump::{CandumpReader, Skipped};
use super::log_file::LogFile;
use super::log_kind::LogKind;
use crate::error::Result;
use asc::Asc;
use blf::BlfReader;
use text::TextReader;
use trc::Trc;

/// Reader of a recording of a bus.
///
/// Times are those of the log, in microseconds. In the formats of Vector and PEAK they begin with the
/// measurement.
pub struct FrameLog(Reader);

enum Reader {
    Candump(Box<CandumpReader>),
    Asc(Box<TextReader<Asc>>),
    Trc(Box<TextReader<Trc>>),
    Blf(Box<BlfReader>),
}

impl FrameLog {
    pub(super) fn candump(file: LogFile) -> Self {
        Self(Reader::Candump(Box::new(CandumpReader::new(file))))
    }

    pub(super) fn asc(file: LogFile) -> Self {
        Self(Reader::Asc(Box::new(TextReader::new(file, Asc::default()))))
    }

    pub(super) fn trc(file: LogFile) -> Self {
        Self(Reader::Trc(Box::new(TextReader::new(file, Trc::default()))))
    }

    pub(super) fn blf(file: LogFile) -> Self {
        Self(Reader::Blf(Box::new(BlfReader::new(file))))
    }

    /// Reads the next frame; `None` at the end.
    ///
    /// # Errors
    /// Returns an error with file, line or byte, and what was expected, for damage, for time that
    /// runs backwards by more than 10 ms, and for a file without frames. A candump log that is cut
    /// off is an error too; a log of another format is used up to there.
    pub fn next_frame(&mut self) -> Result<Option<TimedFrame>> {
        match &mut self.0 {
            Reader::Candump(reader) => reader.next_frame(),
            Reader::Asc(reader) => reader.next_frame(),
            Reader::Trc(reader) => reader.next_frame(),
            Reader::Blf(reader) => reader.next_frame(),
        }
    }

    /// Returns the number of frames skipped so far.
    #[must_use]
    pub const fn skipped(&self) -> Skipped {
        match &self.0 {
            Reader::Candump(reader) => reader.skipped(),
            Reader::Asc(reader) => reader.skipped(),
            Reader::Trc(reader) => reader.skipped(),
            Reader::Blf(reader) => reader.skipped(),
        }
    }

    /// Returns the file, for progress and messages.
    #[must_use]
    pub fn file(&self) -> &LogFile {
        match &self.0 {
            Reader::Candump(reader) => reader.file(),
            Reader::Asc(reader) => reader.file(),
            Reader::Trc(reader) => reader.file(),
            Reader::Blf(reader) => reader.file(),
        }
    }

    /// Returns the kind of the log.
    #[must_use]
    pub const fn kind(&self) -> LogKind {
        match &self.0 {
            Reader::Candump(_) => LogKind::Candump,
            Reader::Asc(_) => LogKind::Asc,
            Reader::Trc(_) => LogKind::Trc,
            Reader::Blf(_) => LogKind::Blf,
        }
    }
}

impl Iterator for FrameLog {
    type Item = Result<TimedFrame>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_frame().transpose()
    }
}
