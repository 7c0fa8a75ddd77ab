//! A log of any kind, known by its content.

use super::frame_log::FrameLog;
use super::log_file::LogFile;
use super::log_kind::{LogKind, kind_of};
use super::log_report::LogReport;
use super::mdf_signals::{self, MdfSignals, Opened};
use super::parquet_table::ParquetTable;
use super::read_options::ReadOptions;
use super::signal_table::{SignalTableReader, is_header};
use crate::error::{Error, Result, on_one_line};
use crate::files::kind::{self, Kind, PARQUET_MAGIC};
use crate::files::log_format::{LogFormat, foreign, foreign_by_name, format_of};
use std::path::Path;

/// An open log.
pub enum Log {
    /// Frames of a bus.
    Frames(Box<FrameLog>),
    /// Rows of a signal table.
    Table(Box<SignalTableReader>),
    /// Rows of a signal table in Parquet.
    Parquet(Box<ParquetTable>),
    /// Rows of the decoded signals of an MDF file.
    Signals(Box<MdfSignals>),
}

impl Log {
    /// Opens a log. Its first bytes decide on its kind; where they do not, its name does, as in
    /// [`kind_of`].
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is of a format that is not read, for the
    /// header of a signal table, and for a mapping of channels where there are none.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self> {
        let log = Self::open_any(path, options)?;
        if options.channels.is_some() && !matches!(log, Self::Signals(_)) {
            return Err(without_channels(path, log.kind()));
        }
        Ok(log)
    }

    fn open_any(path: &Path, options: &ReadOptions) -> Result<Self> {
        let by_name = kind_of(path)?;
        let mut file = LogFile::open(path)?;
        let head = file.look_at_head();
        if head.starts_with(PARQUET_MAGIC) {
            let table = ParquetTable::open(path, options)?;
            return Ok(Self::Parquet(Box::new(table)));
        }
        let format = format_of(head);
        let by_extension = format.is_none().then(|| foreign_by_name(path)).flatten();
        if let Some(advice) = foreign(head).or(by_extension) {
            return Err(Error::content(path, advice));
        }
        let is_table =
            by_name == LogKind::SignalTable || options.columns.is_some() || is_header(head);
        if format.is_none() && is_table {
            let table = SignalTableReader::new(file, options)?;
            return Ok(Self::Table(Box::new(table)));
        }
        if format == Some(LogFormat::Mdf) {
            return Ok(match mdf_signals::open(file, options)? {
                Opened::Frames(frames) => Self::Frames(Box::new(frames)),
                Opened::Signals(signals) => Self::Signals(Box::new(signals)),
            });
        }
        let frames = FrameLog::new(file, format, options)?;
        Ok(Self::Frames(Box::new(frames)))
    }

    /// Returns what the reading told so far.
    #[must_use]
    pub fn report(&self) -> LogReport {
        match self {
            Self::Frames(frames) => frames.report(),
            Self::Signals(signals) => signals.report(),
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
            Self::Signals(_) => LogKind::MdfSignals,
        }
    }
}

/// Returns true for a file whose first bytes are those of a log: runs, maps and others are none.
#[must_use]
pub fn is_log(path: &Path) -> bool {
    let Ok(mut file) = LogFile::open(path) else {
        return false;
    };
    let head = file.look_at_head();
    match kind::of(path) {
        Some(Kind::Parquet) => is_parquet_log(path),
        None | Some(Kind::SignalTable | Kind::FrameLog(_)) => {
            format_of(head).is_some() || is_header(head)
        }
        Some(_) => false,
    }
}

/// Returns true for a table in Parquet that is no run: these have signals, too.
fn is_parquet_log(path: &Path) -> bool {
    let table = ParquetTable::open(path, &ReadOptions::default());
    table.is_ok_and(|table| {
        !table
            .ignored_columns()
            .iter()
            .any(|name| name == "grade_percent")
    })
}

/// Returns true for a file that may be a table of columns that are not ours: text of no other format, or
/// Parquet.
#[must_use]
pub fn is_foreign_table(path: &Path) -> bool {
    let Ok(mut file) = LogFile::open(path) else {
        return false;
    };
    let head = file.look_at_head();
    if head.starts_with(PARQUET_MAGIC) {
        return true;
    }
    let is_text = str::from_utf8(head).map_or_else(|e| e.error_len().is_none(), |_| true);
    is_text && format_of(head).is_none() && foreign(head).is_none()
}

/// Returns true for a table that the mapping of columns fits, if there is one.
#[must_use]
pub fn is_mapped_table(path: &Path, options: &ReadOptions) -> bool {
    let is_table = |log: &Log| matches!(log, Log::Table(_) | Log::Parquet(_));
    options.columns.is_some()
        && is_foreign_table(path)
        && Log::open(path, options).as_ref().is_ok_and(is_table)
}

/// Returns the error for a mapping that names channels of a log without any.
fn without_channels(path: &Path, kind: LogKind) -> Error {
    let path = on_one_line(path);
    let advice = match kind {
        LogKind::SignalTable => "whose columns have the names of our signals; leave out --signals",
        _ => "whose messages a .dbc file describes; give --dbc FILE.dbc, too",
    };
    Error::Usage(format!(
        "--signals without --dbc: {path} is a {kind}, {advice}"
    ))
}
