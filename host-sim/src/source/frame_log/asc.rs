//! Vector's text format (ASC).
//!
//! ```text
//! date Mon Nov 22 10:00:00.000 am 2026
//! base hex  timestamps absolute
//!    0.001000 1  CF00400x       Rx   d 8 01 02 03 04 05 06 07 08
//! ```
//!
//! * An identifier that ends in `x` has 29 bits.
//! * With `base dec`, identifiers and data are decimal.
//! * Relative times are those since the line before.
//! * The date is that of the logger's clock, whatever its time zone.
//! * Lines that are neither frames nor errors of the bus are events, and pass.

use super::calendar::DateTime;
use super::fields::{
    FractionDigits, MOST_MICROS, Words, data_frame, fixed_point, identifier, length_of, number,
};
use super::line_problem::{LineProblem, Parsed, header_problem, problem};
use super::text::{LineFormat, TextLine};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use embedded_can::{Frame, Id};

/// Flag of a CAN FD frame.
const FLEXIBLE_RATE: u32 = 0x1000;
/// Flag of a remote frame.
const REMOTE: u32 = 0x10;
const NO_LENGTH: LineProblem = problem("no data length", "a length from 0 to 8");

/// What the header says on the lines below it.
pub(super) struct Asc {
    radix: u32,
    is_relative: bool,
    micros: i64,
    digits: FractionDigits,
    origin_us: Option<u64>,
}

impl Default for Asc {
    fn default() -> Self {
        Self {
            radix: 16,
            is_relative: false,
            micros: 0,
            digits: FractionDigits::default(),
            origin_us: None,
        }
    }
}

impl LineFormat for Asc {
    fn origin_us(&self) -> Option<u64> {
        self.origin_us
    }

    fn parse(&mut self, line: &[u8], interfaces: &mut Interfaces) -> Parsed<TextLine> {
        let mut words = Words(line);
        let Some(first) = words.next() else {
            return Ok(TextLine::Blank);
        };
        if first.eq_ignore_ascii_case(b"base") {
            self.base(&mut words)?;
        }
        if first.eq_ignore_ascii_case(b"date") {
            self.origin_us = date(&mut words).and_then(|date| date.unix_micros());
        }
        if !matches!(first, [b'0'..=b'9', ..] | [b'-', b'0'..=b'9', ..]) {
            return Ok(TextLine::Other);
        }
        let micros = self.time(first)?;
        match words.next() {
            Some(word) if word.eq_ignore_ascii_case(b"CANFD") => {
                self.fd_event(micros, &mut words, interfaces)
            }
            Some(word) if word.eq_ignore_ascii_case(b"CANXL") => Ok(TextLine::ExtraLarge),
            Some(channel) => match number(channel, 10) {
                Some(channel) => self.event(micros, interfaces.channel(channel), &mut words),
                None => Ok(TextLine::Other),
            },
            None => Ok(TextLine::Other),
        }
    }
}

/// Names of months, in English. Those of other languages than German are not known.
const MONTHS: [&[u8]; 12] = [
    b"jan", b"feb", b"mar", b"apr", b"may", b"jun", b"jul", b"aug", b"sep", b"oct", b"nov", b"dec",
];
/// German names that differ, and their number; umlauts in UTF-8 and Windows-1252.
const GERMAN_MONTHS: [(&[u8], u64); 7] = [
    (b"m\xc3\xa4r", 3),
    (b"m\xe4r", 3),
    (b"mrz", 3),
    (b"mae", 3),
    (b"mai", 5),
    (b"okt", 10),
    (b"dez", 12),
];

fn month(name: &[u8]) -> Option<u64> {
    let name = name.to_ascii_lowercase();
    let english = MONTHS.iter().position(|month| name.starts_with(month));
    let german = GERMAN_MONTHS
        .iter()
        .find(|(month, _)| name.starts_with(month));
    english
        .map(|position| position as u64 + 1)
        .or_else(|| german.map(|(_, month)| *month))
}

/// Reads `Sun Nov 22 10:00:00.000 am 2026`, with or without the fraction and `am`.
fn date(words: &mut Words) -> Option<DateTime> {
    let _weekday = words.next()?;
    let month = month(words.next()?)?;
    let day = number(words.next()?, 10)?.into();
    let mut time = words.next()?.split(|byte| *byte == b':');
    let hour = u64::from(number(time.next()?, 10)?);
    let minute = number(time.next()?, 10)?.into();
    let micros = fixed_point(time.next()?, 6)?;
    let mut last = words.next()?.to_ascii_lowercase();
    let hour = match (last.as_slice(), hour) {
        // Some programs write 24 hours, and `am` or `pm` behind them.
        (b"am" | b"pm", 13..) => hour,
        (b"am", _) => hour % 12,
        // Of 0 hours one cannot say which they are.
        (b"pm", 0) => return None,
        (b"pm", _) => hour % 12 + 12,
        _ => hour,
    };
    if matches!(last.as_slice(), b"am" | b"pm") {
        last = words.next()?.to_vec();
    }
    Some(DateTime {
        year: number(&last, 10)?.into(),
        month,
        day,
        hour,
        minute,
        second: micros / 1_000_000,
        micros: micros % 1_000_000,
    })
}

impl Asc {
    /// Takes `hex  timestamps absolute`.
    fn base(&mut self, words: &mut Words) -> Parsed<()> {
        const BASE: &str =
            "`base hex  timestamps absolute`, `dec` for `hex`, `relative` for `absolute`";
        let wrong = header_problem("no such base or kind of time stamps", BASE);
        self.radix = match words.next() {
            Some(word) if word.eq_ignore_ascii_case(b"hex") => 16,
            Some(word) if word.eq_ignore_ascii_case(b"dec") => 10,
            _ => return Err(wrong),
        };
        let is = |word: Option<&[u8]>, name: &[u8]| {
            word.is_some_and(|word| word.eq_ignore_ascii_case(name))
        };
        // The kind of time stamps may be missing; other words may stand there.
        let has_kind = is(words.next(), b"timestamps");
        let kind = words.next();
        self.is_relative = has_kind && is(kind, b"relative");
        if has_kind && !self.is_relative && !is(kind, b"absolute") {
            return Err(wrong);
        }
        Ok(())
    }

    fn time(&mut self, word: &[u8]) -> Parsed<i64> {
        let wrong = problem("no time", "seconds, such as `0.001000`");
        let micros = self.digits.micros(word).ok_or(wrong)?;
        if !self.is_relative {
            return Ok(micros);
        }
        let sum = self.micros.checked_add(micros);
        let sum = sum.filter(|sum| *sum <= MOST_MICROS);
        self.micros = sum.ok_or(problem("too large a sum of times", "at most 10^12 s"))?;
        Ok(self.micros)
    }

    /// Parses what stands behind time and channel.
    fn event(&self, micros: i64, interface: InterfaceIndex, words: &mut Words) -> Parsed<TextLine> {
        let Some(name) = words.next() else {
            return Ok(TextLine::Other);
        };
        if name.eq_ignore_ascii_case(b"ErrorFrame") {
            return Ok(TextLine::BusError);
        }
        // `TxRq` asks the interface to send; the frame itself follows.
        if !matches!(words.next(), Some(b"Rx" | b"Tx")) {
            return Ok(TextLine::Other);
        }
        let (frame, is_closed) = match words.next() {
            Some(b"d" | b"D") => {
                let id = self.identifier(name)?;
                let word = words.next();
                if is_flexible_rate(word, words) {
                    return Ok(TextLine::FlexibleRate);
                }
                let length = length_of(word, 16)?;
                data_frame(words, id, length, self.radix)?
            }
            Some(b"r" | b"R") => (remote_frame(self.identifier(name)?, words)?, false),
            _ => return Ok(TextLine::Other),
        };
        Ok(TextLine::Frame {
            micros,
            interface,
            frame,
            is_closed,
        })
    }

    /// Parses what stands behind `CANFD`: `1 Rx 18FEF100x 0 0 8  8 01 … 08  130000 130 0 …`, a CAN FD frame
    /// if the flags say so, which are the third number behind the data.
    #[inline(never)] // Rare: the lines of classic frames stay short.
    fn fd_event(
        &self,
        micros: i64,
        words: &mut Words,
        interfaces: &mut Interfaces,
    ) -> Parsed<TextLine> {
        let channel = words.next().and_then(|word| number(word, 10));
        let (_direction, name) = (words.next(), words.next());
        if name.is_some_and(|name| name.eq_ignore_ascii_case(b"ErrorFrame")) {
            return Ok(TextLine::BusError);
        }
        let mut switch = words.next();
        if !matches!(switch, Some(b"0" | b"1")) {
            // The name of the message.
            switch = words.next();
        }
        let is_plain = (switch, words.next()) == (Some(b"0"), Some(b"0"));
        let (code, bytes) = (words.next(), words.next());
        let code = code.and_then(|word| number(word, 16));
        let bytes = bytes.and_then(|word| number(word, 10));
        let flags = |words: &[u8], bytes: u32| {
            let flags = Words(words).nth(bytes as usize + 2)?;
            number(flags, 16)
        };
        let (Some(channel), Some(name), Some(code @ 0..=8), Some(bytes @ 0..=8)) =
            (channel, name, code, bytes)
        else {
            return Ok(TextLine::FlexibleRate);
        };
        let flags = match flags(words.0, bytes) {
            Some(flags) if is_plain && flags & FLEXIBLE_RATE == 0 => flags,
            _ => return Ok(TextLine::FlexibleRate),
        };
        let id = self.identifier(name)?;
        let (frame, is_closed) = if flags & REMOTE != 0 {
            let frame = CanFrame::new_remote(id, code as usize);
            (frame.ok_or(NO_LENGTH)?, false)
        } else {
            data_frame(words, id, bytes as usize, self.radix)?
        };
        Ok(TextLine::Frame {
            micros,
            interface: interfaces.channel(channel),
            frame,
            is_closed,
        })
    }

    fn identifier(&self, word: &[u8]) -> Parsed<Id> {
        let (digits, is_extended) = match word {
            [digits @ .., b'x' | b'X'] => (digits, true),
            digits => (digits, false),
        };
        let id = number(digits, self.radix).and_then(|raw| identifier(raw, is_extended));
        id.ok_or(problem(
            "no CAN identifier",
            "a number up to 7FF, or up to 1FFFFFFF with an `x` behind it, in the base of the header",
        ))
    }
}

/// Parses what stands behind the `r` of a remote frame: a length, or text, or nothing.
fn remote_frame(id: Id, words: &mut Words) -> Parsed<CanFrame> {
    let length = match words.next() {
        Some(word) if number(word, 16).is_some() => length_of(Some(word), 16)?,
        _ => 0,
    };
    CanFrame::new_remote(id, length).ok_or(NO_LENGTH)
}

/// Returns true for a length of more than 8 with more than 8 bytes behind it: a CAN FD frame that a
/// converter wrote as a classic one. A classic frame may have such a length too, and 8 bytes.
fn is_flexible_rate(length: Option<&[u8]>, words: &Words) -> bool {
    if matches!(length, Some([b'0'..=b'8'])) {
        return false;
    }
    let is_long = length.and_then(|word| number(word, 16)) > Some(8);
    let is_byte = |word: &[u8]| word.len() <= 3 && number(word, 16).is_some();
    is_long && Words(words.0).take_while(|word| is_byte(word)).count() > 8
}
