//! One line of a candump log.

use super::calendar::DateTime;
use super::line_problem::{Parsed, problem};
use crate::source::can_frame::CanFrame;
use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// Bit of an error message in SocketCAN's identifier word (`CAN_ERR_FLAG`).
const ERROR_FLAG: u32 = 0x2000_0000;
/// Maximum number of digits of the seconds: microseconds then still fit 64 bits.
const MOST_SECOND_DIGITS: usize = 12;

/// The content of a line.
#[derive(Debug)]
pub(super) struct CandumpLine<'a> {
    pub micros: u64,
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
    /// SocketCAN's report of a fault on the bus.
    BusError,
}

const WHOLE_LINE: &str = "a candump line such as `(1.000000) can0 0CF00400#0102030405060708` \
                          or `(001.000000)  can0  0CF00400   [8]  01 02 03 04 05 06 07 08`";

/// Values of hexadecimal digits; 0xff for any other byte.
const NIBBLES: [u8; 256] = {
    let mut table = [0xff; 256];
    let mut k = 0;
    while k < 10 {
        table[b'0' as usize + k] = k as u8;
        k += 1;
    }
    let mut k = 0;
    while k < 6 {
        table[b'A' as usize + k] = 10 + k as u8;
        table[b'a' as usize + k] = 10 + k as u8;
        k += 1;
    }
    table
};

const fn nibble(byte: u8) -> Option<u8> {
    match NIBBLES[byte as usize] {
        0xff => None,
        value => Some(value),
    }
}

/// The rest of a line.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, byte: u8) -> bool {
        let is_next = self.0.first() == Some(&byte);
        if is_next {
            self.0 = &self.0[1..];
        }
        is_next
    }

    fn skip_blanks(&mut self) -> bool {
        let before = self.0.len();
        while let Some((b' ' | b'\t', rest)) = self.0.split_first() {
            self.0 = rest;
        }
        self.0.len() < before
    }

    fn word(&mut self) -> &'a [u8] {
        let length = self
            .0
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(length);
        self.0 = rest;
        word
    }

    fn pair(&mut self) -> Option<u8> {
        let [high, low, rest @ ..] = self.0 else {
            return None;
        };
        let value = (nibble(*high)? << 4) | nibble(*low)?;
        self.0 = rest;
        Some(value)
    }

    /// Reads the time and the bracket behind it: seconds, or what candump -t A writes.
    fn time(&mut self) -> Option<u64> {
        let start = self.0;
        if let Some(micros) = self.micros() {
            return self.take(b')').then_some(micros);
        }
        self.0 = start;
        self.date().filter(|_| self.take(b')'))
    }

    /// Reads `2026-11-22 10:00:00.000000`, in the time zone of the logger, which is not told.
    fn date(&mut self) -> Option<u64> {
        let mut parts = [0; 5];
        for (part, end) in parts.iter_mut().zip(*b"-- ::") {
            *part = Some(self.decimal())
                .filter(|(_, digits)| (1..=4).contains(digits))?
                .0;
            if !self.take(end) {
                return None;
            }
        }
        let [year, month, day, hour, minute] = parts;
        let micros = self.micros()?;
        DateTime {
            year,
            month,
            day,
            hour,
            minute,
            second: micros / 1_000_000,
            micros: micros % 1_000_000,
        }
        .unix_micros()
    }

    /// Reads `12.345678`. The fraction may have one to nine digits; digits below a microsecond are
    /// cut.
    fn micros(&mut self) -> Option<u64> {
        let (seconds, digits) = self.decimal();
        if digits == 0 || digits > MOST_SECOND_DIGITS || !self.take(b'.') {
            return None;
        }
        let (fraction, digits) = self.decimal();
        let micros = match digits {
            6 => fraction,
            1..=5 => fraction * 10_u64.pow(6 - digits as u32),
            7..=9 => fraction / 10_u64.pow(digits as u32 - 6),
            _ => return None,
        };
        Some(seconds * 1_000_000 + micros)
    }

    /// Reads a number and its count of digits; with more than 19 digits the number is meaningless.
    fn decimal(&mut self) -> (u64, usize) {
        let mut value = 0_u64;
        let mut digits = 0;
        while let Some((byte @ b'0'..=b'9', rest)) = self.0.split_first() {
            value = value.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
            digits += 1;
            self.0 = rest;
        }
        (value, digits)
    }

    /// Reads an identifier; `None` for a bus error.
    fn identifier(&mut self) -> Parsed<Option<Id>> {
        let mut raw = 0_u32;
        let mut digits = 0;
        while let Some((value, rest)) = self
            .0
            .split_first()
            .and_then(|(byte, rest)| Some((nibble(*byte)?, rest)))
        {
            raw = (raw << 4) | u32::from(value);
            digits += 1;
            self.0 = rest;
        }
        let id = match digits {
            3 => StandardId::new(raw as u16).map(|id| Some(Id::from(id))),
            8 if raw & !(ERROR_FLAG - 1) == ERROR_FLAG => Some(None),
            8 => ExtendedId::new(raw).map(|id| Some(Id::from(id))),
            _ => None,
        };
        id.ok_or(problem(
            "no CAN identifier behind time and interface",
            "3 hexadecimal digits up to 7FF, or 8 up to 1FFFFFFF",
        ))
    }
}

/// Returns the time of a line of either layout; `None` if it has none.
pub(super) fn time_of(line: &[u8]) -> Option<u64> {
    let line = line.trim_ascii_start().strip_prefix(b"(")?;
    Cursor(line).time()
}

/// Parses a line without its end; `None` if it is blank.
pub(super) fn parse(line: &[u8]) -> Parsed<Option<CandumpLine<'_>>> {
    let mut rest = Cursor(line);
    rest.skip_blanks();
    if rest.0.is_empty() {
        return Ok(None);
    }
    if !rest.take(b'(') {
        return Err(problem("no time in brackets", WHOLE_LINE));
    }
    let micros = rest.time().ok_or(problem(
        "no time",
        "seconds with a fraction, such as `(1.000000)`",
    ))?;
    rest.skip_blanks();
    let interface = rest.word();
    if interface.is_empty() || !rest.skip_blanks() {
        return Err(problem("no frame behind the time", WHOLE_LINE));
    }
    skip_direction(&mut rest);
    let id = rest.identifier()?;
    let (content, is_closed) = if rest.take(b'#') {
        log_layout(&mut rest, id)?
    } else {
        rest.skip_blanks();
        screen_layout(&mut rest, id)?
    };
    Ok(Some(CandumpLine {
        micros,
        interface,
        content,
        is_closed,
    }))
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
fn log_layout(rest: &mut Cursor, id: Option<Id>) -> Parsed<(Content, bool)> {
    const DATA: &str = "up to 8 bytes of two hexadecimal digits each behind `#`";
    if rest.take(b'#') {
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
        *data
            .get_mut(length)
            .ok_or(problem("too many bytes", DATA))? = value;
        length += 1;
        rest.take(b'.');
    }
    raw_length_code(rest);
    if end_of_log_layout(rest).is_err() {
        return Err(problem("no frame data", DATA));
    }
    Ok((content(id, &data[..length], None), length == data.len()))
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
fn screen_layout(rest: &mut Cursor, id: Option<Id>) -> Parsed<(Content, bool)> {
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
    for byte in &mut data[..length] {
        rest.skip_blanks();
        *byte = rest.pair().ok_or(problem(
            "fewer data than the length in brackets says",
            "as many bytes of two hexadecimal digits each",
        ))?;
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

fn content(id: Option<Id>, data: &[u8], remote_length: Option<usize>) -> Content {
    let frame = id.and_then(|id| match remote_length {
        Some(length) => CanFrame::new_remote(id, length),
        None => CanFrame::new(id, data),
    });
    frame.map_or(Content::BusError, Content::Frame)
}
