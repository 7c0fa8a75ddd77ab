//! One line of a candump log.

use super::candump_cursor::{Cursor, Stamp, nibble};
use super::line_problem::{Parsed, problem};
use crate::source::can_frame::CanFrame;
use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// Bit of an error message in SocketCAN's identifier word (`CAN_ERR_FLAG`).
const ERROR_FLAG: u32 = 0x2000_0000;

/// The content of a line.
#[derive(Debug)]
pub(super) struct CandumpLine<'a> {
    pub stamp: Stamp,
    pub interface: &'a [u8],
    pub content: Content,
    /// True if the line cannot be truncated.
    pub is_closed: bool,
}

#[derive(Debug)]
pub(super) enum Content {
    Frame(CanFrame),
    /// A CAN FD frame.
    FlexibleRate,
    /// A CAN XL frame.
    ExtraLarge,
    /// SocketCAN's report of a fault on the bus.
    BusError,
}

/// Numbers of bytes of CAN FD frames that classic ones cannot have.
const FD_LENGTHS: [usize; 7] = [12, 16, 20, 24, 32, 48, 64];

const WHOLE_LINE: &str = "a candump line such as `(1.000000) can0 0CF00400#0102030405060708` \
                          or `(001.000000)  can0  0CF00400   [8]  01 02 03 04 05 06 07 08`";

/// What stands before the data.
#[derive(Clone, Copy)]
enum Identifier {
    Classic(Id),
    BusError,
    ExtraLarge,
}

/// Reads an identifier.
fn identifier(rest: &mut Cursor) -> Parsed<Identifier> {
    let mut raw = 0_u32;
    let mut digits = 0;
    while let Some((value, behind)) = rest
        .0
        .split_first()
        .and_then(|(byte, behind)| Some((nibble(*byte)?, behind)))
    {
        raw = (raw << 4) | u32::from(value);
        digits += 1;
        rest.0 = behind;
    }
    let id = match digits {
        3 => StandardId::new(raw as u16).map(|id| Identifier::Classic(Id::from(id))),
        // The network of CAN XL stands before its 3 digits.
        5 => Some(Identifier::ExtraLarge),
        8 if raw & !(ERROR_FLAG - 1) == ERROR_FLAG => Some(Identifier::BusError),
        8 => ExtendedId::new(raw).map(|id| Identifier::Classic(Id::from(id))),
        _ => None,
    };
    id.ok_or(problem(
        "no CAN identifier behind time and interface",
        "3 hexadecimal digits up to 7FF, or 8 up to 1FFFFFFF",
    ))
}

/// Returns the time of a line of either layout; `None` if it has none.
pub(super) fn time_of(line: &[u8]) -> Option<i64> {
    let line = line.trim_ascii_start().strip_prefix(b"(")?;
    Cursor(line).time().map(|stamp| stamp.micros)
}

/// Parses a line without its end; `None` if it is no frame: a comment, text of `candump -e`.
pub(super) fn parse(line: &[u8]) -> Parsed<Option<CandumpLine<'_>>> {
    let mut rest = Cursor(line);
    rest.skip_blanks();
    if !rest.take(b'(') {
        return if has_frame(rest.0) {
            Err(problem("no time in brackets", WHOLE_LINE))
        } else {
            Ok(None)
        };
    }
    let stamp = rest.time().ok_or(problem(
        "no time",
        "seconds with a fraction, such as `(1.000000)`",
    ))?;
    rest.skip_blanks();
    let interface = rest.word();
    if interface.is_empty() || !rest.skip_blanks() {
        return Err(problem("no frame behind the time", WHOLE_LINE));
    }
    skip_direction(&mut rest);
    let (content, is_closed) = match identifier(&mut rest)? {
        Identifier::ExtraLarge => (Content::ExtraLarge, false),
        id if rest.take(b'#') => log_layout(&mut rest, id)?,
        id => {
            rest.skip_blanks();
            screen_layout(&mut rest, id)?
        }
    };
    Ok(Some(CandumpLine {
        stamp,
        interface,
        content,
        is_closed,
    }))
}

/// Returns true for a line without a time that has the rest of a frame: `123#01`, `[8]`. A line of hexadecimal
/// digits alone is the end of one.
fn has_frame(line: &[u8]) -> bool {
    if let [] | [b'#' | b';' | b'/' | b'%', ..] = line {
        return false;
    }
    let is_digit = |byte: &u8| nibble(*byte).is_some();
    let is_part = |part: &[u8]| match part {
        [.., digit, b'#'] => is_digit(digit),
        [b'[', digit, b']'] => is_digit(digit),
        _ => false,
    };
    let has_part = |length: usize| line.windows(length).any(is_part);
    let is_end = line
        .iter()
        .all(|byte| is_digit(byte) || matches!(byte, b' ' | b'.' | b'\t'));
    is_end || has_part(2) || has_part(3)
}

/// Skips `RX` or `TX` and two flags, which candump -x writes before the identifier on the screen.
fn skip_direction(rest: &mut Cursor) {
    if matches!(rest.0, [b'R' | b'T', b'X', b' ', ..]) {
        for _ in 0..3 {
            rest.word();
            rest.skip_blanks();
        }
    }
}

/// Parses `0CF00400#01020304`, `123#R4`, `123##1AABB` (candump -l and -L).
fn log_layout(rest: &mut Cursor, id: Identifier) -> Parsed<(Content, bool)> {
    const DATA: &str = "up to 8 bytes of two hexadecimal digits each behind `#`";
    if rest.take(b'#') {
        // `###` stands before the header of CAN XL in the first version of its layout.
        if rest.take(b'#') {
            return Ok((Content::ExtraLarge, false));
        }
        while rest.0.first().is_some_and(|byte| nibble(*byte).is_some()) {
            rest.0 = &rest.0[1..];
        }
        end_of_log_layout(rest)?;
        return Ok((Content::FlexibleRate, false));
    }
    if rest.take(b'R') || rest.take(b'r') {
        let length = match rest.0.split_first() {
            Some((digit @ b'0'..=b'8', behind)) => {
                rest.0 = behind;
                usize::from(digit - b'0')
            }
            _ => 0,
        };
        raw_length_code(rest);
        end_of_log_layout(rest)?;
        return Ok((content(id, &[], Some(length)), false));
    }
    let mut data = [0; 8];
    let mut length = 0;
    while let Some(value) = rest.pair() {
        if let Some(byte) = data.get_mut(length) {
            *byte = value;
        }
        length += 1;
        rest.take(b'.');
    }
    raw_length_code(rest);
    if end_of_log_layout(rest).is_err() {
        return Err(problem("no frame data", DATA));
    }
    match data.get(..length) {
        Some(bytes) => Ok((content(id, bytes, None), length == data.len())),
        // A converter that does not know the mark of CAN FD.
        None if FD_LENGTHS.contains(&length) => Ok((Content::FlexibleRate, false)),
        None => Err(problem("too many bytes", DATA)),
    }
}

/// Skips `_` and the raw length code, which candump -8 writes after the data.
fn raw_length_code(rest: &mut Cursor) {
    if let [b'_', code, behind @ ..] = rest.0
        && nibble(*code).is_some()
    {
        rest.0 = behind;
    }
}

/// Checks the end of the line: nothing, or the `R` or `T` of candump -x.
fn end_of_log_layout(rest: &mut Cursor) -> Parsed<()> {
    let is_apart = rest.skip_blanks();
    let is_end = rest.0.is_empty() || (is_apart && matches!(rest.0, [b'R' | b'T']));
    is_end
        .then_some(())
        .ok_or(problem("unknown text behind the frame", WHOLE_LINE))
}

/// Parses `0CF00400   [8]  01 02 …`, `123   [0]  remote request`, `123  [08]  …` for CAN FD
/// (candump on a terminal). Text after the data is candump's comment.
fn screen_layout(rest: &mut Cursor, id: Identifier) -> Parsed<(Content, bool)> {
    const LENGTH: &str = "`#` and data, or a length such as `[8]`";
    let length = match rest.0 {
        [b'[', digit @ b'0'..=b'8', b']', behind @ ..] => {
            rest.0 = behind;
            usize::from(digit - b'0')
        }
        // candump pads the length of CAN FD frames to two digits, also below 10.
        [b'[', b'0'..=b'9', b'0'..=b'9', b']', ..] => return Ok((Content::FlexibleRate, false)),
        _ => return Err(problem("no frame data", LENGTH)),
    };
    rest.skip_blanks();
    if rest.0.starts_with(b"remote request") {
        return Ok((content(id, &[], Some(length)), true));
    }
    let mut data = [0; 8];
    let bytes = &mut data[..length];
    if !bytes.is_empty() {
        read_bytes(rest, bytes)?;
    }
    if rest
        .0
        .first()
        .is_some_and(|byte| !byte.is_ascii_whitespace())
    {
        return Err(problem("no frame data", "bytes set apart by blanks"));
    }
    Ok((content(id, &data[..length], None), true))
}

/// Reads bytes of two hexadecimal digits; of eight binary ones, as candump -i writes; or set apart by ` in
/// reverse order, as -S does.
fn read_bytes(rest: &mut Cursor, bytes: &mut [u8]) -> Parsed<()> {
    let start = rest.0.trim_ascii_start();
    let is_binary = start
        .get(..8)
        .is_some_and(|word| word.iter().all(|byte| matches!(byte, b'0' | b'1')))
        && start.get(8).is_none_or(u8::is_ascii_whitespace);
    let is_swapped = start.get(2) == Some(&b'`');
    for byte in bytes.iter_mut() {
        rest.skip_blanks();
        let value = if is_binary { rest.bits() } else { rest.pair() };
        *byte = value.ok_or(problem(
            "fewer data than the length in brackets says",
            "as many bytes of two hexadecimal digits each",
        ))?;
        let is_apart = match rest.0.first() {
            Some(b'`') if is_swapped => rest.take(b'`'),
            Some(next) => next.is_ascii_whitespace(),
            None => true,
        };
        if !is_apart {
            return Err(problem("no frame data", "bytes set apart by blanks"));
        }
    }
    if is_swapped {
        bytes.reverse();
    }
    Ok(())
}

fn content(id: Identifier, data: &[u8], remote_length: Option<usize>) -> Content {
    let id = match id {
        Identifier::Classic(id) => id,
        Identifier::BusError => return Content::BusError,
        Identifier::ExtraLarge => return Content::ExtraLarge,
    };
    let frame = match remote_length {
        Some(length) => CanFrame::new_remote(id, length),
        None => CanFrame::new(id, data),
    };
    frame.map_or(Content::BusError, Content::Frame)
}
