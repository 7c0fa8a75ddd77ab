//! The time of a recording, sent along with it.
//!
//! A frame that is replayed is stamped by the kernel anew, so that what is estimated from it
//! differs in the last digits from what is estimated from the log. With a frame that tells the
//! log's own time ahead of each change of it, the estimate is the same to the last bit, at any
//! speed. The same frame asks the listener whether it is ready for more, without which a replay at
//! full speed would overrun it: a virtual interface takes frames faster than anyone can read them.
//!
//! The message is of the range that J1939-21 leaves to manufacturers, beside those of
//! [`estimator_core::broadcast`]: seven bytes of microseconds, least first, and one that says what
//! is meant.

use super::can_frame::CanFrame;
use embedded_can::{ExtendedId, Frame, Id};
use estimator_core::Instant;
use estimator_core::signal::Pgn;

/// Its parameter group.
pub const PGN: u32 = 0xFF48;
/// Address of an off-board tool (J1939, table B2).
const SOURCE: u32 = 0xF9;
/// Highest priority: it is the time of what follows.
const PRIORITY: u32 = 0;
/// Microseconds that fit: 2,283 years.
const MICROS_END: u64 = 1 << 56;

/// What the message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogTime {
    /// What follows is of this time.
    Now(Instant),
    /// The same, and please answer when everything before is read.
    Ready(Instant),
    /// Everything before this time is read.
    Answer(Instant),
    /// The log is over, please answer.
    End(Instant),
}

impl LogTime {
    /// As a frame; `None` for a time that does not fit.
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

    /// From a frame; `None` if it is another message.
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
