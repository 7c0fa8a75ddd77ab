//! One object of a BLF file.

use super::byte_file::{number, u16_at, u32_at};
use super::fields::{MOST_MICROS, identifier};
use crate::source::can_frame::CanFrame;
use embedded_can::Frame;

/// Bytes of the shortest header of an object with a time.
const LEAST_HEADER_BYTES: usize = 32;
/// Bit of an identifier with 29 bits.
const EXTENDED: u32 = 1 << 31;
/// Mask of the bits of an identifier.
const ID_MASK: u32 = 0x1fff_ffff;

/// What an object records.
pub(super) enum Recorded {
    Frame {
        micros: i64,
        channel: u16,
        frame: CanFrame,
    },
    /// A CAN FD frame.
    FlexibleRate,
    BusError,
    /// An object that has no frame of a bus.
    Other,
}

/// Why an object cannot be read.
pub(super) struct ObjectProblem {
    pub what: &'static str,
    pub expected: &'static str,
}

const fn problem(what: &'static str, expected: &'static str) -> ObjectProblem {
    ObjectProblem { what, expected }
}

const SHORT: ObjectProblem = problem("an object shorter than its type", "all of its fields");

/// Reads an object.
///
/// # Errors
/// Returns what is wrong with it.
pub(super) fn recorded(object: &[u8]) -> Result<Recorded, ObjectProblem> {
    let body = |object| body(object).ok_or(SHORT);
    Ok(match u32_at(object, 12).ok_or(SHORT)? {
        // CAN_MESSAGE, CAN_MESSAGE2
        1 | 86 => {
            let body = body(object)?;
            let is_remote = body.get(2).ok_or(SHORT)? & 0x80 != 0;
            let [dlc] = number(body, 3).ok_or(SHORT)?;
            frame(object, body, 4, dlc, is_remote, 8)?
        }
        // CAN_FD_MESSAGE, of which some are classic frames
        100 => {
            let body = body(object)?;
            let [flags, dlc] = number(body, 2).ok_or(SHORT)?;
            let [fd_flags] = number(body, 13).ok_or(SHORT)?;
            if fd_flags & 1 != 0 {
                return Ok(Recorded::FlexibleRate);
            }
            frame(object, body, 4, dlc, flags & 0x80 != 0, 20)?
        }
        // CAN_FD_MESSAGE_64, likewise
        101 => {
            let body = body(object)?;
            let [dlc] = number(body, 1).ok_or(SHORT)?;
            let flags = u32_at(body, 12).ok_or(SHORT)?;
            if flags & 0x1000 != 0 {
                return Ok(Recorded::FlexibleRate);
            }
            frame(object, body, 4, dlc, flags & 0x10 != 0, 40)?
        }
        // CAN_ERROR, CAN_ERROR_EXT, CAN_FD_ERROR_64
        2 | 73 | 104 => Recorded::BusError,
        _ => Recorded::Other,
    })
}

/// Returns what stands behind the header of an object.
fn body(object: &[u8]) -> Option<&[u8]> {
    let header = usize::from(u16_at(object, 4)?);
    object.get(header.max(LEAST_HEADER_BYTES)..)
}

/// Reads a classic frame with the identifier and the data at these places of the body.
fn frame(
    object: &[u8],
    body: &[u8],
    id_at: usize,
    dlc: u8,
    is_remote: bool,
    data_at: usize,
) -> Result<Recorded, ObjectProblem> {
    let micros = micros(object)?;
    let channel = channel(object, body).ok_or(SHORT)?;
    let raw = u32_at(body, id_at).ok_or(SHORT)?;
    let id = identifier(raw & ID_MASK, raw & EXTENDED != 0).ok_or(problem(
        "an identifier with too many bits",
        "11, or 29 with bit 31 set",
    ))?;
    // Codes from 9 to 15 mean 8 bytes too.
    let length = usize::from(dlc).min(8);
    let frame = if is_remote {
        CanFrame::new_remote(id, length)
    } else {
        let data = body.get(data_at..).and_then(|data| data.get(..length));
        CanFrame::new(id, data.ok_or(SHORT)?)
    };
    let frame = frame.ok_or(SHORT)?;
    Ok(Recorded::Frame {
        micros,
        channel,
        frame,
    })
}

/// Returns the channel of a frame, from 1. A CAN_FD_MESSAGE_64 has it in one byte.
fn channel(object: &[u8], body: &[u8]) -> Option<u16> {
    if u32_at(object, 12)? == 101 {
        return body.first().map(|channel| u16::from(*channel));
    }
    u16_at(body, 0)
}

/// Returns the time of an object, in microseconds.
fn micros(object: &[u8]) -> Result<i64, ObjectProblem> {
    let flags = u32_at(object, 16).ok_or(SHORT)?;
    let time = number(object, 24).map(u64::from_le_bytes).ok_or(SHORT)?;
    let micros = match flags {
        1 => time.checked_mul(10),
        // Rounded: programs that count in floating point write 1,829,999 ns for 1.830 ms.
        2 => Some(time.saturating_add(500) / 1000),
        _ => return Err(problem("an unknown unit of time", "1 (10 µs) or 2 (ns)")),
    };
    let micros = micros.and_then(|micros| i64::try_from(micros).ok());
    let micros = micros.filter(|micros| *micros <= MOST_MICROS);
    micros.ok_or(problem("too late a time", "at most 10^12 s"))
}
