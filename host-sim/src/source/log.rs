//! A log of any kind, known by its content.

use super::frame_log::FrameLog;
use super::log_file::LogFile;
use super::log_kind::{LogKind, kind_of};
use super::parquet_table::ParquetTable;
use super::read_options::ReadOptions;
use super::signal_table::SignalTableReader;
use crate::error::{Error, Result};
use crate::files::kind::PARQUET_MAGIC;
use crate::files::log_format::{LogFormat, foreign, format_of};
use std::path::Path;

/// An open log.
pub enum Log {
    /// Frames of a bus.
    Frames(FrameLog),
    /// Rows of a signal table.
    Table(Box<SignalTableReader>),
    /// Rows of a signal table in Parquet.
    Parquet(Box<ParquetTable>),
}

impl Log {
    /// Opens a log. Its first bytes decide on its kind; where they do not, its name does, as in
    /// [`kind_of`].
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is of a format that is not read, or for the
    /// header of a signal table.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self> {
        let by_name = kind_of(path)?;
        let mut file = LogFile::open(path)?;
        let head = file.look_at_head();
        if head.starts_with(PARQUET_MAGIC) {
            return ParquetTable::open(path).map(|table| Self::Parquet(Box::new(table)));
        }
        if let Some(advice) = foreign(head) {
            return Err(Error::content(path, advice));
        }
        let format = format_of(head);
        let frames = match format {
            Some(LogFormat::Asc) => FrameLog::asc(file),
            Some(LogFormat::Trc) => FrameLog::trc(file),
            Some(LogFormat::Blf) => FrameLog::blf(file),
            None if by_name == LogKind::SignalTable => {
                let mut table = SignalTableReader::new(file)?;
                table.ignore(&options.ignore);
                return Ok(Self::Table(Box::new(table)));
            }
            None => FrameLog::candump(file),
        };
        Ok(Self::Frames(frames))
    }

    /// Returns the kind of the log.
    #[must_use]
    pub const fn kind(&self) -> LogKind {
        match self {
            Self::Frames(frames) => frames.kind(),
            Self::Table(_) | Self::Parquet(_) => LogKind::SignalTable,
        }
    }
}
