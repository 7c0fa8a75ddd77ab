//! What a log of either kind holds, one input after the other.

use super::can_frame::{CanFrame, TimedFrame};
use super::candump::CandumpReader;
use super::log_kind::{LogKind, kind_of};
use super::signal_table::SignalTableReader;
use crate::error::Result;
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use estimator_core::{Instant, Reading, Signal, Value};
use std::path::Path;

/// Combination vehicle weight, CVW.
const CVW: u32 = 65_136;

/// One thing that was heard.
#[derive(Clone, Copy, Debug)]
pub enum Input {
    /// A frame of a bus.
    Frame(TimedFrame),
    /// A reading of a signal table.
    Reading(Instant, Reading),
}

impl Input {
    /// When.
    #[must_use]
    pub const fn time(&self) -> Instant {
        match self {
            Self::Frame(frame) => frame.time,
            Self::Reading(time, _) => *time,
        }
    }

    /// The same, with the vehicle's mass as not available: for an estimator that knows it better
    /// than the bus.
    #[must_use]
    pub fn without_mass(self) -> Self {
        match self {
            Self::Frame(TimedFrame { time, frame }) if tells_mass(&frame) => {
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

fn tells_mass(frame: &CanFrame) -> bool {
    matches!(frame.id(), Id::Extended(id) if Pgn::from_raw(id.as_raw()).number == CVW)
}

/// Hands every input of a log to `take`. `progress` is told the bytes read so far, now and then.
///
/// # Errors
/// A log that cannot be read to its end, with file and line.
pub fn for_each_input(
    log: &Path,
    progress: impl Fn(u64),
    mut take: impl FnMut(Input),
) -> Result<()> {
    match kind_of(log)? {
        LogKind::Candump => {
            let mut reader = CandumpReader::open(log)?;
            let mut frames = 0_u32;
            while let Some(frame) = reader.next_frame()? {
                take(Input::Frame(frame));
                frames = frames.wrapping_add(1);
                if frames.is_multiple_of(8192) {
                    progress(reader.file().bytes_read());
                }
            }
        }
        LogKind::SignalTable => {
            let mut reader = SignalTableReader::open(log)?;
            while let Some(row) = reader.next_row()? {
                for reading in row.readings {
                    take(Input::Reading(row.time, *reading));
                }
            }
        }
    }
    Ok(())
}
