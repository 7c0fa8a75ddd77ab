//! What the readers of all formats have in common.

use crate::error::{Error, Result};
use crate::source::can_frame::CanFrame;
use crate::source::damage::DamageCheck;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use crate::source::log_file::LogFile;
use crate::source::time_order::Timed;
use std::fmt;

/// A frame as a log has it.
#[derive(Clone, Copy, Debug)]
pub(in crate::source) struct LoggedFrame {
    /// Time in the log, µs; negative before the trigger of a measurement.
    pub micros: i64,
    pub interface: InterfaceIndex,
    pub frame: CanFrame,
}

impl Timed for LoggedFrame {
    fn micros(&self) -> i64 {
        self.micros
    }
}

/// Number of frames skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// CAN FD frames: J1939 on classic CAN and NMEA 2000 have none.
    pub can_fd: u64,
    /// CAN XL frames.
    pub can_xl: u64,
    /// Records that their file marks as invalid.
    pub invalid: u64,
    /// Bus errors that the interface reported.
    pub bus_errors: u64,
    /// Messages of other networks in the same file.
    pub foreign: u64,
}

impl Skipped {
    /// Returns what was skipped, in words; `None` if that is nothing.
    pub(super) fn words(&self) -> Option<String> {
        let counts = [
            (self.can_fd, "CAN FD frames"),
            (self.can_xl, "CAN XL frames"),
            (self.bus_errors, "bus errors"),
            (self.invalid, "records marked as invalid"),
            (self.foreign, "messages of other networks"),
        ];
        let found = counts.iter().filter(|(count, _)| *count > 0);
        let words: Vec<String> = found
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}

/// What a reader notes of its log.
pub(in crate::source) struct LogNotes {
    pub frames: u64,
    pub skipped: Skipped,
    pub damage: DamageCheck,
    pub interfaces: Interfaces,
    /// Time of the log's time 0, in microseconds since the Unix epoch, if the log has it.
    pub origin_us: Option<u64>,
}

impl LogNotes {
    pub(super) fn new(is_strict: bool) -> Self {
        Self {
            frames: 0,
            skipped: Skipped::default(),
            damage: DamageCheck::new(is_strict),
            interfaces: Interfaces::default(),
            origin_us: None,
        }
    }

    /// Counts a frame and returns it.
    pub(super) fn frame(
        &mut self,
        micros: i64,
        interface: InterfaceIndex,
        frame: CanFrame,
    ) -> LoggedFrame {
        self.frames += 1;
        self.interfaces.count_frame(interface);
        LoggedFrame {
            micros,
            interface,
            frame,
        }
    }
}

/// A reader of frames in the order in which they are logged.
pub(in crate::source) trait FrameReader: Send {
    /// Reads the next frame; `None` at the end.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read on.
    fn next_logged(&mut self) -> Result<Option<LoggedFrame>>;

    /// Returns an error at the place that was read last.
    fn error(&self, problem: &str, expected: &str) -> Error;

    fn file(&self) -> &LogFile;

    fn notes(&self) -> &LogNotes;

    fn notes_mut(&mut self) -> &mut LogNotes;

    /// Returns the number of lines read so far; in a binary format, of frames.
    fn lines(&self) -> u64 {
        let notes = self.notes();
        notes.frames + notes.damage.found().lines
    }
}

/// Returns what is done to times that begin below zero, in words.
pub(in crate::source) fn moved_to_zero(first_us: Option<i64>) -> Option<String> {
    let first = Seconds(first_us.filter(|first_us| *first_us < 0)?);
    Some(format!("times begin at {first}; moved to begin with zero"))
}

/// A time in microseconds, as candump writes it.
#[derive(Clone, Copy)]
pub(in crate::source) struct Seconds(pub(in crate::source) i64);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let micros = self.0.unsigned_abs();
        write!(
            f,
            "{sign}{}.{:06} s",
            micros / 1_000_000,
            micros % 1_000_000
        )
    }
}
