//! The bytes of a line of candump, taken from its head.

use super::calendar::DateTime;
use super::fields::overflowed;
use super::line_problem::{Parsed, problem};

/// Maximum number of digits of the seconds: microseconds then still fit 64 bits.
const MOST_SECOND_DIGITS: usize = 12;

/// The time of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamp {
    /// Digits below a microsecond are cut.
    pub micros: i64,
    pub fraction_digits: usize,
    /// The time if the fraction is a count of microseconds.
    overflowed: Option<i64>,
}

impl Stamp {
    /// Returns the time, with the fraction as a count of microseconds.
    ///
    /// # Errors
    /// Returns what is wrong with that count.
    pub(super) fn overflowed(&self) -> Parsed<i64> {
        self.overflowed.ok_or(problem(
            "no time",
            "a fraction of six digits, as in the other lines",
        ))
    }
}

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

pub(super) const fn nibble(byte: u8) -> Option<u8> {
    match NIBBLES[byte as usize] {
        0xff => None,
        value => Some(value),
    }
}

/// The rest of a line.
pub(super) struct Cursor<'a>(pub(super) &'a [u8]);

impl<'a> Cursor<'a> {
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let is_next = self.0.first() == Some(&byte);
        if is_next {
            self.0 = &self.0[1..];
        }
        is_next
    }

    pub(super) fn skip_blanks(&mut self) -> bool {
        let before = self.0.len();
        while let Some((b' ' | b'\t', rest)) = self.0.split_first() {
            self.0 = rest;
        }
        self.0.len() < before
    }

    pub(super) fn word(&mut self) -> &'a [u8] {
        let length = self
            .0
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(length);
        self.0 = rest;
        word
    }

    pub(super) fn pair(&mut self) -> Option<u8> {
        let [high, low, rest @ ..] = self.0 else {
            return None;
        };
        let value = (nibble(*high)? << 4) | nibble(*low)?;
        self.0 = rest;
        Some(value)
    }

    /// Reads a byte of eight binary digits.
    pub(super) fn bits(&mut self) -> Option<u8> {
        let (bits, rest) = self.0.split_at_checked(8)?;
        let add = |sum: u8, bit: &u8| match bit {
            b'0' | b'1' => Some(sum << 1 | (bit - b'0')),
            _ => None,
        };
        let value = bits.iter().try_fold(0, add)?;
        self.0 = rest;
        Some(value)
    }

    /// Reads the time and the bracket behind it: seconds, or what candump -t A writes.
    pub(super) fn time(&mut self) -> Option<Stamp> {
        let start = self.0;
        let is_negative = self.take(b'-');
        if let Some(stamp) = self.stamp() {
            let sign = if is_negative { -1 } else { 1 };
            let micros = sign * stamp.micros;
            return self.take(b')').then_some(Stamp { micros, ..stamp });
        }
        self.0 = start;
        self.date().filter(|_| self.take(b')'))
    }

    /// Reads `2026-11-22 10:00:00.000000`, in the time zone of the logger, which is not told.
    fn date(&mut self) -> Option<Stamp> {
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
        let stamp = self.stamp()?;
        let micros = u64::try_from(stamp.micros).ok()?;
        let unix = DateTime {
            year,
            month,
            day,
            hour,
            minute,
            second: micros / 1_000_000,
            micros: micros % 1_000_000,
        }
        .unix_micros()?;
        let micros = i64::try_from(unix).ok()?;
        let shift = micros - stamp.micros;
        Some(Stamp {
            micros,
            overflowed: stamp.overflowed.map(|time| time + shift),
            ..stamp
        })
    }

    /// Reads `12.345678`. The fraction may have one to nine digits.
    fn stamp(&mut self) -> Option<Stamp> {
        let (seconds, digits) = self.decimal();
        if digits == 0 || digits > MOST_SECOND_DIGITS || !self.take(b'.') {
            return None;
        }
        let (fraction, fraction_digits) = self.decimal();
        let micros = match fraction_digits {
            6 => fraction,
            1..=5 => fraction * 10_u64.pow(6 - fraction_digits as u32),
            7..=9 => fraction / 10_u64.pow(fraction_digits as u32 - 6),
            _ => return None,
        };
        // At most 18 digits.
        let whole_us = (seconds * 1_000_000) as i64;
        Some(Stamp {
            micros: whole_us + micros as i64,
            fraction_digits,
            overflowed: overflowed(whole_us, fraction as u32),
        })
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
}
