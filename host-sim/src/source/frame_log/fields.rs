//! Fields of a line: words set apart by blanks, numbers, identifiers, data.

use super::line_problem::{LineProblem, Parsed, problem};
use crate::source::can_frame::CanFrame;
use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// Maximum number of digits before the point: microseconds then still fit 64 bits.
const MOST_WHOLE_DIGITS: usize = 12;
/// Latest time of a log, as for candump: estimates do not overflow.
pub(super) const MOST_MICROS: i64 = 1_000_000_000_000_000_000;
/// Maximum number of data bytes of a classic frame.
const MOST_BYTES: usize = 8;

/// The words of a line that are not taken yet.
pub(super) struct Words<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let line = self.0.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = line.split_at_checked(end.unwrap_or(line.len()))?;
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// Returns the value of `12.345678`, or with a comma as the decimal point, times 10 to the power of `places`; digits below that are cut.
/// `None` if it is not such a number.
pub(super) fn fixed_point(word: &[u8], places: usize) -> Option<u64> {
    fixed_point_at(word, point_of(word), places)
}

/// Returns where the decimal point of a number is.
#[inline]
fn point_of(word: &[u8]) -> Option<usize> {
    word.iter().position(|byte| matches!(byte, b'.' | b','))
}

#[inline] // For each line.
fn fixed_point_at(word: &[u8], point: Option<usize>, places: usize) -> Option<u64> {
    let (whole, fraction) = match point {
        Some(at) => (word.get(..at)?, word.get(at + 1..)?),
        None => (word, &b""[..]),
    };
    if whole.is_empty() || whole.len() > MOST_WHOLE_DIGITS {
        return None;
    }
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    if !whole.iter().all(is_digit) || !fraction.iter().all(is_digit) {
        return None;
    }
    let fraction = fraction.iter().chain(std::iter::repeat(&b'0')).take(places);
    whole
        .iter()
        .chain(fraction)
        .try_fold(0_u64, |value, digit| {
            value.checked_mul(10)?.checked_add(u64::from(digit - b'0'))
        })
}

/// Returns the value of a number with a sign, as [`fixed_point`] does.
pub(super) fn signed_fixed_point(word: &[u8], places: usize) -> Option<i64> {
    let (digits, sign) = match word {
        [b'-', digits @ ..] => (digits, -1),
        digits => (digits, 1),
    };
    let value = i64::try_from(fixed_point(digits, places)?).ok()?;
    Some(sign * value)
}

/// The digits of the fractions of a log's seconds.
///
/// Some writers count microseconds on to 1000000 instead of to the next second: among fractions of six
/// digits, one of seven is a count of microseconds.
#[derive(Default)]
pub(super) struct FractionDigits {
    six: u64,
    seven: u64,
}

impl FractionDigits {
    /// Takes a fraction of so many digits. Returns true if it is a count of microseconds.
    pub(super) const fn is_overflow(&mut self, digits: usize) -> bool {
        match digits {
            6 => self.six += 1,
            7 => {
                let is_overflow = self.six >= 3 * (self.seven + 1);
                self.seven += 1;
                return is_overflow;
            }
            _ => {}
        }
        false
    }

    /// Reads seconds in microseconds.
    #[inline]
    pub(super) fn micros(&mut self, word: &[u8]) -> Option<i64> {
        let (digits, is_negative) = match word {
            [b'-', digits @ ..] => (digits, true),
            digits => (digits, false),
        };
        let point = point_of(digits);
        let places = point.map_or(0, |at| digits.len() - at - 1);
        if self.is_overflow(places) {
            let (whole, fraction) = digits.split_at(point?);
            let fraction = number(fraction.get(1..)?, 10)?;
            let whole = i64::try_from(fixed_point(whole, 6)?).ok()?;
            return overflowed(whole, fraction).filter(|_| !is_negative);
        }
        let micros = i64::try_from(fixed_point_at(digits, point, 6)?).ok()?;
        Some(if is_negative { -micros } else { micros })
    }
}

/// Returns the microseconds of seconds and a count that may be more than one.
pub(super) fn overflowed(whole_us: i64, fraction_us: u32) -> Option<i64> {
    (fraction_us < 2_000_000).then(|| whole_us + i64::from(fraction_us))
}

/// Returns the value of a word of digits only.
pub(super) fn number(word: &[u8], radix: u32) -> Option<u32> {
    if word.is_empty() {
        return None;
    }
    word.iter().try_fold(0_u32, |value, byte| {
        let digit = char::from(*byte).to_digit(radix)?;
        value.checked_mul(radix)?.checked_add(digit)
    })
}

/// Returns an identifier, if it has no more than its 11 or 29 bits.
pub(super) fn identifier(raw: u32, is_extended: bool) -> Option<Id> {
    if is_extended {
        ExtendedId::new(raw).map(Id::from)
    } else {
        let raw = u16::try_from(raw).ok()?;
        StandardId::new(raw).map(Id::from)
    }
}

/// Returns the number of bytes for a data length code: 9 to 15 mean 8 in a classic frame.
pub(super) fn length_of(word: Option<&[u8]>, radix: u32) -> Parsed<usize> {
    let code = word.and_then(|word| number(word, radix));
    match code {
        Some(code @ 0..=15) => Ok((code as usize).min(MOST_BYTES)),
        _ => Err(problem("no data length", "a number of bytes from 0 to 8")),
    }
}

/// Takes the data of a frame from the words. Returns true with it if the last byte cannot have lost
/// a digit.
pub(super) fn data_frame(
    words: &mut Words,
    id: Id,
    length: usize,
    radix: u32,
) -> Parsed<(CanFrame, bool)> {
    const FEWER: LineProblem = problem(
        "fewer data than the length says",
        "as many bytes as the length says",
    );
    let mut data = [0; MOST_BYTES];
    let mut is_closed = true;
    let bytes = data.get_mut(..length).ok_or(FEWER)?;
    for byte in bytes.iter_mut() {
        let word = words.next().ok_or(FEWER)?;
        let value = number(word, radix).and_then(|value| u8::try_from(value).ok());
        *byte = value.ok_or(problem(
            "no byte of data",
            "numbers up to FF (255 in decimal) set apart by blanks",
        ))?;
        is_closed = !words.0.is_empty() || (radix == 16 && word.len() == 2);
    }
    let frame = CanFrame::new(id, bytes).ok_or(FEWER)?;
    Ok((frame, is_closed))
}
