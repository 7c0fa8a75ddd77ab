//! The time stamps of a log, sent with its replay.
//!
//! The kernel stamps a replayed frame anew, so an estimate from the replay differs from that of the
//! log in the last digits. A frame with the log's time, sent before each change of it, makes both
//! estimates equal to the last bit, at any speed. The same frame asks the listener for an
//! acknowledgement. Without it a replay at full speed would overrun the listener: a virtual
//! interface accepts frames faster than they can be read.
//!
//! The message is in the range that J1939-21 leaves to manufacturers, beside those of
//! [`estimator_core::broadcast`]: seven bytes of microseconds, least significant first, and one
//! byte for the kind.

use super::can_frame::CanFrame;
use embedded_can::{ExtendedId, Frame, Id};
use estimator_core::Instant;
use estimator_core::signal::Pgn;

/// Its parameter group.
pub const PGN: u32 = 0xFF48;
/// Address of an off-board tool (J1939, table B2).
const SOURCE: u32 = 0xF9;
/// Highest priority: it is the time of the following frames.
const PRIORITY: u32 = 0;
/// Limit of the microseconds: 2,283 years.
const MICROS_END: u64 = 1 << 56;

/// Kinds of the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogTime {
    /// The following frames have this time.
    Now(Instant),
    /// The following frames have this time; acknowledge when all earlier frames are read.
    Ready(Instant),
    /// All frames before this time are read.
    Answer(Instant),
    /// The log is over; acknowledge.
    End(Instant),
}

impl LogTime {
    /// Encodes the message; `None` for a time that does not fit.
    #[must_use]
    pub fn frame(self) -> Option<CanFrame> {
        let (code, time) = match self {
            Self::Now(time) => (0, time),
            Self::Ready(time) => (1, time),
            Self::Answer(time) => (2, time),
            Self::End(time) => (3, time),
        };
        let micros = Some(time.micros()).filter(|micros| *micros < MICROS_END)?;
        let mut data = micros.to_le_bytes();
        data[7] = code;
        CanFrame::extended(PRIORITY << 26 | PGN << 8 | SOURCE, &data)
    }

    /// Decodes the message; `None` for another message.
    #[must_use]
    pub fn read(frame: &CanFrame) -> Option<Self> {
        let Id::Extended(id) = frame.id() else {
            return None;
        };
        if !is_of_group(id) {
            return None;
        }
        let mut data: [u8; 8] = frame.data().try_into().ok()?;
        let code = std::mem::take(&mut data[7]);
        let time = Instant::from_micros(u64::from_le_bytes(data));
        match code {
            0 => Some(Self::Now(time)),
            1 => Some(Self::Ready(time)),
            2 => Some(Self::Answer(time)),
            3 => Some(Self::End(time)),
            _ => None,
        }
    }
}

fn is_of_group(id: ExtendedId) -> bool {
    Pgn::from_raw(id.as_raw()).number == PGN
}
