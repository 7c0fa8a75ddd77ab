//! Time stamps of the loggers CL1000, CL2000 and CL3000 of CSS Electronics, down to the millisecond.
//!
//! ```text
//! # Time: 20170101T022232      when the file was begun
//! # Time format: 4
//! 01T022231683                 day, hours, minutes, seconds, milliseconds
//! ```
//!
//! A configuration chooses which parts a stamp has, and what stands between them; the count of digits
//! tells. Ten digits before a point are seconds since the Unix epoch.

use super::calendar::DateTime;
use super::fields::fixed_point;
use super::line_problem::{Parsed, problem};
use super::rolling_clock::{DAY_US, RollingClock};

/// Digits of the seconds since the Unix epoch, and of such milliseconds.
const EPOCH_DIGITS: usize = 10;
const EPOCH_MILLISECOND_DIGITS: usize = 13;
/// The format with the day, in 11 digits, and that with month and day, which has as many digits as
/// milliseconds since the epoch.
const DAY: u32 = 4;
const MONTH_AND_DAY: u32 = 5;
/// Digits of a time of day.
const TIME_DIGITS: usize = 9;
/// A day of a month with 31 days, for stamps that name only the day, without a time of the file.
const FIRST_MONTH: (u64, u64) = (1970, 1);

/// The clock of such a log.
#[derive(Default)]
pub(super) struct ClxClock {
    format: Option<u32>,
    clock: RollingClock,
}

impl ClxClock {
    /// Takes a line of the header, without its `#`.
    pub(super) fn header(&mut self, line: &[u8]) {
        let Some((name, value)) = str::from_utf8(line)
            .ok()
            .and_then(|line| line.split_once(':'))
        else {
            return;
        };
        match name.trim() {
            "Time" => {
                let digits = digits_of(value.trim().as_bytes()).unwrap_or_default();
                if let Some(micros) = whole(&[&digits[..], &[0; 3]].concat()) {
                    self.clock = RollingClock::from_start(micros);
                }
            }
            "Time format" => self.format = value.trim().parse().ok(),
            _ => {}
        }
    }

    /// Reads a stamp, in microseconds.
    pub(super) fn micros(&mut self, field: &[u8]) -> Parsed<i64> {
        self.stamp(field).ok_or(problem(
            "no time",
            "a stamp such as `01T022231683`, or seconds since 1970",
        ))
    }

    fn stamp(&mut self, field: &[u8]) -> Option<i64> {
        let is_bare = field.iter().all(u8::is_ascii_digit);
        let point = field.iter().position(|byte| !byte.is_ascii_digit());
        if point == Some(EPOCH_DIGITS) && self.format != Some(MONTH_AND_DAY) {
            return fixed_point(field, 6).and_then(|micros| i64::try_from(micros).ok());
        }
        let digits = digits_of(field)?;
        if is_bare && digits.len() == EPOCH_MILLISECOND_DIGITS && self.format != Some(MONTH_AND_DAY)
        {
            let (seconds, thousandths) = field.split_at_checked(EPOCH_DIGITS)?;
            return fixed_point(&[seconds, b".", thousandths].concat(), 6)
                .and_then(|micros| i64::try_from(micros).ok());
        }
        let of_time = field.rsplit(|byte| *byte == b'T').next()?;
        let is_cut = of_time.len() < field.len() && digits_of(of_time)?.len() != TIME_DIGITS;
        if is_cut || (self.format == Some(DAY) && digits.len() != TIME_DIGITS + 2) {
            return None;
        }
        let number = |from: usize, count: usize| number(digits.get(from..from + count)?);
        let parts = match digits.len() {
            17 => return whole(&digits),
            15 => return whole(&[&[2, 0], &digits[..]].concat()),
            13 => {
                let (year, _) = FIRST_MONTH;
                let leap_year = year + 2;
                let date = (leap_year, number(0, 2)?, number(2, 2)?);
                let micros = date_and_time(date, digits.get(4..)?)?;
                return Some(self.clock.within_months(micros, 12));
            }
            11 => {
                let (year, month) = FIRST_MONTH;
                let micros = date_and_time((year, month, number(0, 2)?), digits.get(2..)?)?;
                return Some(self.clock.within_months(micros, 1));
            }
            9 => (number(0, 2)?, number(2, 2)?, number(4, 2)?, DAY_US),
            7 => (0, number(0, 2)?, number(2, 2)?, DAY_US / 24),
            5 => (0, 0, number(0, 2)?, DAY_US / 24 / 60),
            _ => return None,
        };
        let (hour, minute, second, period_us) = parts;
        let thousandths = number(digits.len() - 3, 3)?;
        let micros = of_day(hour, minute, second, thousandths)?;
        Some(self.clock.within(micros, period_us))
    }
}

/// Returns the values of the digits, if nothing else but marks stands between them.
fn digits_of(field: &[u8]) -> Option<Vec<u8>> {
    let is_mark = |byte: &u8| !byte.is_ascii_alphanumeric() || *byte == b'T';
    let is_stamp = field
        .iter()
        .all(|byte| byte.is_ascii_digit() || is_mark(byte));
    let digits = field.iter().filter(|byte| byte.is_ascii_digit());
    is_stamp.then(|| digits.map(|byte| byte - b'0').collect())
}

fn number(digits: &[u8]) -> Option<u64> {
    let value = |sum: u64, digit: &u8| 10 * sum + u64::from(*digit);
    Some(digits.iter().fold(0, value))
}

/// Returns the microseconds since the Unix epoch of year, month, day and time, in 17 digits.
fn whole(digits: &[u8]) -> Option<i64> {
    let part = |from: usize, count: usize| number(digits.get(from..from + count)?);
    let date = (part(0, 4)?, part(4, 2)?, part(6, 2)?);
    date_and_time(date, digits.get(8..)?)
}

/// Returns the same of a date and nine digits of a time of day.
fn date_and_time((year, month, day): (u64, u64, u64), time: &[u8]) -> Option<i64> {
    let part = |from: usize, count: usize| number(time.get(from..from + count)?);
    if time.len() != TIME_DIGITS {
        return None;
    }
    let micros = DateTime {
        year,
        month,
        day,
        hour: part(0, 2)?,
        minute: part(2, 2)?,
        second: part(4, 2)?,
        micros: 1000 * part(6, 3)?,
    }
    .unix_micros()?;
    i64::try_from(micros).ok()
}

fn of_day(hour: u64, minute: u64, second: u64, thousandths: u64) -> Option<i64> {
    let is_time = hour < 24 && minute < 60 && second < 60;
    let seconds = 3600 * hour + 60 * minute + second;
    is_time.then(|| (1_000_000 * seconds + 1000 * thousandths) as i64)
}
