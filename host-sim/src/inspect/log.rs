//! The census of a whole log, in constant memory.

use super::census::{BusCounter, Census, TableCounter};
use super::dbc_census::DbcCounter;
use crate::error::Result;
use crate::source::can_frame::TimedFrame;
use crate::source::frame_log::FrameLog;
use crate::source::log::Log;
use crate::source::log_kind::LogKind;
use crate::source::log_report::LogReport;
use crate::source::mdf_signals::MdfSignals;
use crate::source::parquet_table::ParquetTable;
use crate::source::read_options::ReadOptions;
use crate::source::signal_table::SignalTableReader;
use std::path::Path;

/// Number of frames or rows between two calls of `progress`.
const PROGRESS_STEP: u64 = 1 << 16;

/// Reads a log and returns its kind, its census, and what the reading told. `progress` gets the
/// number of bytes read so far, `dbc` each frame.
///
/// # Errors
/// Returns an error with file and line (or byte) if the log cannot be read to its end.
pub fn census_of(
    log: &Path,
    options: &ReadOptions,
    mut dbc: Option<&mut DbcCounter>,
    progress: impl Fn(u64),
) -> Result<(LogKind, Census, LogReport)> {
    let mut log = Log::open(log, options)?;
    let kind = log.kind();
    let census = match &mut log {
        Log::Frames(frames) => {
            let look = |frame: &TimedFrame| {
                if let Some(dbc) = &mut dbc {
                    dbc.add(&frame.frame);
                }
            };
            count_frames(frames, options, look, progress)?
        }
        Log::Table(table) => count_rows(table, progress)?,
        Log::Parquet(table) => count_parquet_rows(table)?,
        Log::Signals(signals) => count_signals(signals, progress)?,
    };
    Ok((kind, census, log.report()))
}

fn count_frames(
    log: &mut FrameLog,
    options: &ReadOptions,
    mut look: impl FnMut(&TimedFrame),
    progress: impl Fn(u64),
) -> Result<Census> {
    let mut counter = BusCounter::of(options);
    let mut frames = 0_u64;
    while let Some(frame) = log.next_frame()? {
        counter.add(&frame);
        look(&frame);
        frames += 1;
        if frames.is_multiple_of(PROGRESS_STEP) {
            progress(log.file().bytes_read());
        }
    }
    Ok(counter.finish(log.skipped()))
}

fn count_rows(table: &mut SignalTableReader, progress: impl Fn(u64)) -> Result<Census> {
    let mut counter = TableCounter::new(table.signals());
    let mut rows = 0_u64;
    while let Some(row) = table.next_row()? {
        counter.add(&row);
        rows += 1;
        if rows.is_multiple_of(PROGRESS_STEP) {
            progress(table.file().bytes_read());
        }
    }
    Ok(counter.finish())
}

fn count_signals(log: &mut MdfSignals, progress: impl Fn(u64)) -> Result<Census> {
    let channels = log.census()?;
    let mut counter = TableCounter::new(log.signals());
    let mut rows = 0_u64;
    let is_mapped = log.signals().next().is_some();
    while is_mapped && let Some(row) = log.next_row()? {
        counter.add(&row);
        rows += 1;
        if rows.is_multiple_of(PROGRESS_STEP) {
            progress(log.file().bytes_read());
        }
    }
    Ok(Census {
        channels,
        ..counter.finish()
    })
}

fn count_parquet_rows(table: &mut ParquetTable) -> Result<Census> {
    let mut counter = TableCounter::new(table.signals());
    while let Some(row) = table.next_row()? {
        counter.add(&row);
    }
    Ok(counter.finish())
}
