//! Kernel filters: the messages that the decoder reads, from any source address.

use crate::source::can_frame::{TRANSPORT_DATA, TRANSPORT_MANAGEMENT};
use estimator_core::signal;
use estimator_core::signal::own_message::FrameMatch;

/// Bit of a 29-bit identifier in SocketCAN's identifier word (`CAN_EFF_FLAG`).
const EXTENDED: u32 = 0x8000_0000;
/// The bits of an 11-bit and of a 29-bit identifier.
const STANDARD_BITS: u32 = 0x7ff;
const EXTENDED_BITS: u32 = 0x1fff_ffff;
/// The bits of a parameter group in an identifier: extended data page, data page, PDU format,
/// PDU specific; without priority and source address (J1939-21).
const GROUP: u32 = 0x03ff_ff00;
/// The same where PDU specific is a destination.
const GROUP_TO_DESTINATION: u32 = 0x03ff_0000;
/// PDU formats below have a destination (PDU1).
const FIRST_BROADCAST_FORMAT: u32 = 0xf0;

/// Returns the filter of a parameter group: identifier and mask as SocketCAN words. It passes every
/// priority, source address and destination.
#[must_use]
pub const fn of_group(pgn: u32) -> (u32, u32) {
    let mask = if (pgn >> 8) & 0xff < FIRST_BROADCAST_FORMAT {
        GROUP_TO_DESTINATION
    } else {
        GROUP
    };
    (EXTENDED | (pgn << 8 & mask), EXTENDED | mask)
}

/// Returns the filter of the frames of an own message.
#[must_use]
pub const fn of_frames(frames: FrameMatch) -> (u32, u32) {
    match frames {
        FrameMatch::Standard(id) => (id as u32, EXTENDED | STANDARD_BITS),
        FrameMatch::Extended(id) => (EXTENDED | id, EXTENDED | EXTENDED_BITS),
        FrameMatch::Group(pgn) => of_group(pgn),
    }
}

/// Filters of diagnostic answers (ISO 15765-4): 7E8 to 7EF, and those to the tester.
const ANSWERS: [(u32, u32); 2] = [
    (0x7e8, EXTENDED | 0x7f8),
    (EXTENDED | 0x18da_f100, EXTENDED | 0x1fff_ff00),
];

/// Returns the filters of all decoded messages, from the layouts in `estimator-core/dbc`, of the
/// transport protocol, and of diagnostic answers.
#[must_use]
pub fn wanted() -> Vec<(u32, u32)> {
    // EC1 comes in packets, whose identifiers do not tell what they carry.
    let packets = [TRANSPORT_MANAGEMENT, TRANSPORT_DATA];
    let messages = signal::messages().map(|message| message.pgn());
    let groups = messages.chain(packets).map(of_group);
    groups.chain(ANSWERS).collect()
}

/// Returns true if any of `filters` accepts an identifier word, as the kernel decides it.
#[must_use]
pub fn accepts(filters: &[(u32, u32)], word: u32) -> bool {
    filters.iter().any(|(id, mask)| word & mask == id & mask)
}
