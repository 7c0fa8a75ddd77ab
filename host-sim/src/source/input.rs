//! The inputs of a log of any kind, in order.

use super::can_frame::{CanFrame, TimedFrame};
use super::log::Log;
use super::log_report::LogReport;
use super::read_options::ReadOptions;
use crate::error::Result;
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use estimator_core::{Instant, Reading, Signal, Value};
use std::path::Path;

/// Combination vehicle weight, CVW.
const CVW: u32 = 65_136;

/// One input of the estimator.
#[derive(Clone, Copy, Debug)]
pub enum LogInput {
    /// A frame of a bus.
    Frame(TimedFrame),
    /// A reading of a signal table.
    Reading(Instant, Reading),
}

impl LogInput {
    /// Returns the time of the input.
    #[must_use]
    pub const fn time(&self) -> Instant {
        match self {
            Self::Frame(frame) => frame.time,
            Self::Reading(time, _) => *time,
        }
    }

    /// Returns the input with the vehicle mass marked as not available, for an estimator whose mass
    /// is more accurate than that of the bus.
    #[must_use]
    pub fn without_mass(self) -> Self {
        match self {
            Self::Frame(TimedFrame { time, frame }) if carries_mass(&frame) => {
                let unknown = [0xff; 8];
                let frame = CanFrame::new(frame.id(), &unknown).unwrap_or(frame);
                Self::Frame(TimedFrame { time, frame })
            }
            Self::Reading(time, reading) if reading.signal == Signal::Mass => {
                let value = Value::NotAvailable;
                Self::Reading(time, Reading { value, ..reading })
            }
            other => other,
        }
    }
}

fn carries_mass(frame: &CanFrame) -> bool {
    matches!(frame.id(), Id::Extended(id) if Pgn::from_raw(id.as_raw()).number == CVW)
}

/// Passes every input of a log to `take`, and the bytes read so far to `progress`. Returns what the
/// reading told besides.
///
/// # Errors
/// Returns an error with file and line (or byte) if the log cannot be read to its end.
pub fn for_each_input(
    log: &Path,
    options: &ReadOptions,
    progress: impl Fn(u64),
    mut take: impl FnMut(LogInput),
) -> Result<LogReport> {
    let mut log = Log::open(log, options)?;
    match &mut log {
        Log::Frames(reader) => {
            let mut frames = 0_u32;
            while let Some(frame) = reader.next_frame()? {
                take(LogInput::Frame(frame));
                frames = frames.wrapping_add(1);
                if frames.is_multiple_of(8192) {
                    progress(reader.file().bytes_read());
                }
            }
        }
        Log::Table(reader) => {
            while let Some(row) = reader.next_row()? {
                for reading in row.readings {
                    take(LogInput::Reading(row.time, *reading));
                }
            }
        }
    }
    Ok(log.report())
}
