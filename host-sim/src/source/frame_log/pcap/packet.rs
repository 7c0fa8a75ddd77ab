//! What a captured packet contains: a frame of SocketCAN, bare or behind the header of a "cooked" capture.
//!
//! * `LINKTYPE_CAN_SOCKETCAN` (227): the identifier is big-endian.
//! * `LINKTYPE_LINUX_SLL` (113) and `SLL2` (276), as `tcpdump -i any` writes them: the kernel's bytes, so
//!   the identifier has the byte order of the capturing machine, which is that of the file (libpcap swaps
//!   both together).
//! * A frame without the flag of CAN FD may still be one: old writers did not set it. It then has 72
//!   bytes (<https://www.tcpdump.org/linktypes/LINKTYPE_CAN_SOCKETCAN.html>).

use super::super::byte_file::number;
use super::super::fields::identifier;
use super::super::line_problem::{LineProblem, Parsed, problem};
use crate::source::can_frame::CanFrame;
use embedded_can::Frame;

/// Bytes before the data of a frame.
const HEADER_BYTES: usize = 8;
/// Size of a whole CAN FD frame.
const FD_FRAME_BYTES: u32 = 72;
/// Most data bytes of a classic frame, and of a CAN FD frame.
const MOST_BYTES: usize = 8;
const MOST_FD_BYTES: usize = 64;
/// Bits of the identifier: 29 bits, remote, error.
const EXTENDED: u32 = 0x8000_0000;
const REMOTE: u32 = 0x4000_0000;
const ERROR: u32 = 0x2000_0000;
const ID_MASK: u32 = 0x1fff_ffff;
/// Marks of CAN XL, in the byte of the length, and of CAN FD, in the byte behind it.
const EXTRA_LARGE: u8 = 0x80;
const FLEXIBLE_RATE: u8 = 0x04;

/// What a packet begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Link {
    SocketCan,
    /// Linux cooked capture.
    Cooked,
    /// Its second version, which has the index of the interface.
    Cooked2,
    /// Another network, by its number.
    Other(u16),
}

impl Link {
    pub(super) const fn of(number: u16) -> Self {
        match number {
            227 => Self::SocketCan,
            113 => Self::Cooked,
            276 => Self::Cooked2,
            other => Self::Other(other),
        }
    }
}

/// What a packet contains.
pub(super) enum Content {
    Frame(CanFrame),
    FlexibleRate,
    ExtraLarge,
    BusError,
    /// A packet of another network.
    Foreign,
}

/// A packet as it was captured.
pub(super) struct Packet<'a> {
    pub link: Link,
    pub bytes: &'a [u8],
    /// Its size on the bus, of which the capture may have kept less.
    pub whole_bytes: u32,
    /// The byte order of the file.
    pub is_big_endian: bool,
}

impl Packet<'_> {
    /// Returns the index of the interface, if the packet has it.
    pub(super) fn interface(&self) -> Option<u32> {
        match self.link {
            Link::Cooked2 => number(self.bytes, 4).map(u32::from_be_bytes),
            _ => None,
        }
    }

    /// Reads the packet.
    ///
    /// # Errors
    /// Returns what is wrong with it.
    pub(super) fn content(&self) -> Parsed<Content> {
        let (header_bytes, protocol_at) = match self.link {
            Link::SocketCan => return frame(self.bytes, self.whole_bytes, true),
            Link::Cooked => (16, 14),
            Link::Cooked2 => (20, 0),
            Link::Other(_) => return Ok(Content::Foreign),
        };
        let protocol = number(self.bytes, protocol_at).ok_or(SHORT)?;
        let whole_bytes = self.whole_bytes.saturating_sub(header_bytes as u32);
        // Linux: ETH_P_CAN, ETH_P_CANFD, ETH_P_CANXL.
        match u16::from_be_bytes(protocol) {
            0x000c => {
                let bytes = self.bytes.get(header_bytes..).ok_or(SHORT)?;
                frame(bytes, whole_bytes, self.is_big_endian)
            }
            0x000d => Ok(Content::FlexibleRate),
            0x000e => Ok(Content::ExtraLarge),
            _ => Ok(Content::Foreign),
        }
    }
}

const SHORT: LineProblem = problem(
    "a packet shorter than its frame",
    "all bytes of the frame (a longer snapshot length when capturing)",
);

fn frame(bytes: &[u8], whole_bytes: u32, is_big_endian: bool) -> Parsed<Content> {
    let raw = number(bytes, 0).ok_or(SHORT)?;
    let raw = if is_big_endian {
        u32::from_be_bytes(raw)
    } else {
        u32::from_le_bytes(raw)
    };
    let [length, flags] = number(bytes, 4).ok_or(SHORT)?;
    if length & EXTRA_LARGE != 0 {
        return Ok(Content::ExtraLarge);
    }
    if raw & ERROR != 0 {
        return Ok(Content::BusError);
    }
    let length = usize::from(length);
    if length > MOST_FD_BYTES {
        return Err(problem("no data length", "a number of bytes from 0 to 8"));
    }
    let is_fd_size = whole_bytes == FD_FRAME_BYTES;
    if flags & FLEXIBLE_RATE != 0 || length > MOST_BYTES || is_fd_size {
        return Ok(Content::FlexibleRate);
    }
    let id = identifier(raw & ID_MASK, raw & EXTENDED != 0).ok_or(problem(
        "an identifier with too many bits",
        "11, or 29 with bit 31 set",
    ))?;
    let frame = if raw & REMOTE != 0 {
        CanFrame::new_remote(id, length)
    } else {
        let data = bytes
            .get(HEADER_BYTES..)
            .and_then(|data| data.get(..length));
        CanFrame::new(id, data.ok_or(SHORT)?)
    };
    frame.map(Content::Frame).ok_or(SHORT)
}
