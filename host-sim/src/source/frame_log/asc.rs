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
use super::fields::{MOST_MICROS, Words, data_frame, fixed_point, identifier, length_of, number};
use super::line_problem::{Parsed, header_problem, problem};
use super::text::{LineFormat, TextLine};
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::{InterfaceIndex, Interfaces};
use embedded_can::{Frame, Id};

/// What the header says on the lines below it.
pub(super) struct Asc {
    radix: u32,
    is_relative: bool,
    micros: u64,
    origin_us: Option<u64>,
}

impl Default for Asc {
    fn default() -> Self {
        Self {
            radix: 16,
            is_relative: false,
            micros: 0,
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
            return Ok(TextLine::Other);
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
                let is_error = words.any(|word| word.eq_ignore_ascii_case(b"ErrorFrame"));
                Ok(if is_error {
                    TextLine::BusError
                } else {
                    TextLine::FlexibleRate
                })
            }
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
    let hour = match last.as_slice() {
        b"am" => hour % 12,
        b"pm" => hour % 12 + 12,
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
            Some(b"hex") => 16,
            Some(b"dec") => 10,
            _ => return Err(wrong),
        };
        self.is_relative = match (words.next(), words.next()) {
            (None, _) | (Some(b"timestamps"), Some(b"absolute")) => false,
            (Some(b"timestamps"), Some(b"relative")) => true,
            _ => return Err(wrong),
        };
        Ok(())
    }

    fn time(&mut self, word: &[u8]) -> Parsed<u64> {
        let wrong = problem("no time", "seconds from 0, such as `0.001000`");
        let micros = fixed_point(word, 6).ok_or(wrong)?;
        if !self.is_relative {
            return Ok(micros);
        }
        let sum = self.micros.checked_add(micros);
        let sum = sum.filter(|sum| *sum <= MOST_MICROS);
        self.micros = sum.ok_or(problem("too large a sum of times", "at most 10^12 s"))?;
        Ok(self.micros)
    }

    /// Parses what stands behind time and channel.
    fn event(&self, micros: u64, interface: InterfaceIndex, words: &mut Words) -> Parsed<TextLine> {
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
                let length = length_of(words.next(), 16)?;
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
    CanFrame::new_remote(id, length).ok_or(problem("no data length", "a length from 0 to 8"))
}
