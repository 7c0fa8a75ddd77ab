//! Whole messages of a log, in the frames that carry them on a bus.
//!
//! Gateways put fast packets and multi-packet messages together before they write them down. The decoder
//! expects frames, as other logs have them.

use super::line_problem::{LineProblem, Parsed, problem};
use crate::source::can_frame::CanFrame;

/// NMEA 2000: the lowest parameter group that fast packets carry, and their longest payload.
const FIRST_OF_FAST_PACKETS: u32 = 126_208;
const MOST_OF_FAST_PACKET: usize = 223;
/// SAE J1939-21: the longest payload of the transport protocol.
const MOST_BYTES: usize = 1785;
/// Parameter groups have 18 bits.
const MOST_PGN: u32 = 0x3_ffff;
/// Formats below this one are sent to an address, which stands in the identifier.
const FIRST_TO_ALL: u32 = 240;

/// A message.
#[derive(Clone, Copy, Debug)]
pub(super) struct WholeMessage<'a> {
    pub priority: u32,
    pub pgn: u32,
    pub source: u8,
    pub destination: u8,
    pub data: &'a [u8],
}

const TOO_LONG: LineProblem = problem("too many bytes", "at most 1785 bytes of a message");

impl WholeMessage<'_> {
    /// Returns the raw identifier; `None` if the message is of no bus: gateways write their own ones with
    /// numbers above those of parameter groups.
    fn id(&self) -> Option<u32> {
        if self.pgn > MOST_PGN || self.priority > 7 {
            return None;
        }
        let is_to_all = self.pgn >> 8 & 0xff >= FIRST_TO_ALL;
        let group = if is_to_all {
            self.pgn
        } else {
            self.pgn & !0xff | u32::from(self.destination)
        };
        Some(self.priority << 26 | group << 8 | u32::from(self.source))
    }

    /// Returns the message with an identifier of 29 bits.
    pub(super) fn of_id(id: u32, data: &[u8]) -> WholeMessage<'_> {
        let group = id >> 8 & MOST_PGN;
        let is_to_all = group >> 8 & 0xff >= FIRST_TO_ALL;
        WholeMessage {
            priority: id >> 26 & 7,
            pgn: if is_to_all { group } else { group & !0xff },
            source: id as u8,
            destination: if is_to_all { 0xff } else { group as u8 },
            data,
        }
    }
}

/// Splits messages.
#[derive(Default)]
pub(super) struct Splitter {
    sequence: u8,
}

impl Splitter {
    /// Returns the frames of a message; none of one that is not of the bus.
    ///
    /// # Errors
    /// Returns what is wrong with it.
    pub(super) fn split(&mut self, message: &WholeMessage) -> Parsed<Vec<CanFrame>> {
        let Some(id) = message.id() else {
            return Ok(Vec::new());
        };
        let data = message.data;
        if data.len() > MOST_BYTES {
            return Err(TOO_LONG);
        }
        let is_single = data.len() <= 8;
        let is_fast = message.pgn >= FIRST_OF_FAST_PACKETS && data.len() <= MOST_OF_FAST_PACKET;
        if is_single || is_fast {
            if is_fast && !is_single {
                self.sequence = (self.sequence + 1) % 8;
            }
            return Ok(CanFrame::carrying(id, self.sequence, data).collect());
        }
        Ok(CanFrame::broadcast(message.pgn, message.source, data).collect())
    }
}
