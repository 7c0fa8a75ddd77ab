//! The inputs of a log of any kind, in order.

use super::can_frame::{CanFrame, TimedFrame};
use super::frame_readings::FrameReadings;
use super::log::Log;
use super::log_report::LogReport;
use super::read_options::ReadOptions;
use super::signal_table::SignalRow;
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
    /// A reading of a signal table, an own message or a diagnostic answer.
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

    /// Returns the same input at another time.
    #[must_use]
    pub const fn at(self, time: Instant) -> Self {
        match self {
            Self::Frame(frame) => Self::Frame(TimedFrame { time, ..frame }),
            Self::Reading(_, reading) => Self::Reading(time, reading),
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

/// Passes every input of a log to `take`, and the bytes read so far to `progress`. The readings of own
/// messages and diagnostic answers come after the frame, which may be a built-in message too. Returns what is noteworthy
/// in the log.
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
    let mut unseen_signals = Vec::new();
    let mut has_diagnostic_torque = false;
    let mut vehicle_number = None;
    let mut pace = Pace::default();
    match &mut log {
        Log::Frames(reader) => {
            let mut readings = FrameReadings::of(options.signals.as_ref());
            while let Some(frame) = reader.next_frame()? {
                take(LogInput::Frame(frame));
                readings.decode(&frame, |reading| {
                    take(LogInput::Reading(frame.time, reading));
                });
                if pace.is_due() {
                    options.stop.check()?;
                    progress(reader.file().bytes_read());
                }
            }
            let unseen = readings.unseen().iter();
            unseen_signals = unseen.map(|signal| signal.column()).collect();
            has_diagnostic_torque = readings.obd().gives(Signal::EngineTorque);
            vehicle_number = readings.vehicle_number().map(str::to_owned);
        }
        Log::Signals(reader) => {
            while let Some(row) = reader.next_row()? {
                pass_on(&row, &mut take);
                if pace.is_due() {
                    options.stop.check()?;
                    progress(reader.file().bytes_read());
                }
            }
        }
        Log::Parquet(reader) => {
            while let Some(row) = reader.next_row()? {
                pass_on(&row, &mut take);
                if pace.is_due() {
                    options.stop.check()?;
                }
            }
        }
        Log::Table(reader) => {
            while let Some(row) = reader.next_row()? {
                pass_on(&row, &mut take);
                if pace.is_due() {
                    options.stop.check()?;
                }
            }
        }
    }
    Ok(LogReport {
        unseen_signals,
        has_diagnostic_torque,
        vehicle_number,
        ..log.report()
    })
}

/// Tells when to look up from the reading: once in some thousand frames or rows.
#[derive(Debug, Default)]
pub struct Pace(u32);

impl Pace {
    /// Counts a frame or a row, and returns whether it is time to look up.
    pub const fn is_due(&mut self) -> bool {
        self.0 = self.0.wrapping_add(1);
        self.0.is_multiple_of(8_192)
    }
}

fn pass_on(row: &SignalRow, take: &mut impl FnMut(LogInput)) {
    for reading in row.readings {
        take(LogInput::Reading(row.time, *reading));
    }
}
