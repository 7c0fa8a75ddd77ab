//! A log of any kind, known by its content.

use super::frame_log::FrameLog;
use super::log_file::LogFile;
use super::log_kind::{LogKind, kind_of};
use super::log_report::LogReport;
use super::parquet_table::ParquetTable;
use super::read_options::ReadOptions;
use super::signal_table::SignalTableReader;
use crate::error::{Error, Result};
use crate::files::kind::PARQUET_MAGIC;
use crate::files::log_format::{foreign, foreign_by_name, format_of};
use std::path::Path;

/// The column that every signal table has.
const TIME: &[u8] = b"time_s";

/// An open log.
pub enum Log {
    /// Frames of a bus.
    Frames(Box<FrameLog>),
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
            let table = ParquetTable::open(path, &options.ignore, options.strict)?;
            return Ok(Self::Parquet(Box::new(table)));
        }
        let format = format_of(head);
        let by_extension = format.is_none().then(|| foreign_by_name(path)).flatten();
        if let Some(advice) = foreign(head).or(by_extension) {
            return Err(Error::content(path, advice));
        }
        let is_table = by_name == LogKind::SignalTable || is_header_of_table(head);
        if format.is_none() && is_table {
            let mut table = SignalTableReader::new(file, options.strict)?;
            table.ignore(&options.ignore);
            return Ok(Self::Table(Box::new(table)));
        }
        let frames = FrameLog::new(file, format, options)?;
        Ok(Self::Frames(Box::new(frames)))
    }

    /// Returns what the reading told so far.
    #[must_use]
    pub fn report(&self) -> LogReport {
        match self {
            Self::Frames(frames) => frames.report(),
            Self::Table(table) => LogReport {
                damage: table.damage().clone(),
                mended: table.mended(),
                ignored_columns: table.ignored_columns().to_vec(),
                ..LogReport::default()
            },
            Self::Parquet(table) => LogReport {
                damage: table.damage().clone(),
                mended: table.mended(),
                ignored_columns: table.ignored_columns().to_vec(),
                ..LogReport::default()
            },
        }
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

fn is_header_of_table(head: &[u8]) -> bool {
    let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let mut names = line.split(|byte| *byte == b',');
    names.any(|name| name.trim_ascii() == TIME)
}
