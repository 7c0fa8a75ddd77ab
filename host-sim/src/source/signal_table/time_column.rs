//! The time of a row: seconds, other units, or a date (ISO 8601).

use chrono::{DateTime, NaiveDateTime};

/// The time column, in seconds from any origin.
pub const TIME: &str = "time_s";

/// The unit of a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// A number of seconds.
    Seconds,
    /// A number of milliseconds.
    Milliseconds,
    /// A number of microseconds.
    Microseconds,
    /// A number of nanoseconds.
    Nanoseconds,
    /// A date with a time of day, such as 2026-11-22T10:00:00.250+01:00. Without a zone it is in UTC.
    Date,
}

use TimeUnit::{Date, Microseconds, Milliseconds, Nanoseconds, Seconds};

/// Names of units.
const NAMES: [(&str, TimeUnit); 9] = [
    ("s", Seconds),
    ("sec", Seconds),
    ("ms", Milliseconds),
    ("us", Microseconds),
    ("µs", Microseconds),
    ("μs", Microseconds),
    ("ns", Nanoseconds),
    ("iso", Date),
    ("date", Date),
];
/// Numbers above are times since 1970 in this unit; below the last one they may be anything.
const SINCE_1970: [(f64, TimeUnit); 4] = [
    (1e17, Nanoseconds),
    (1e14, Microseconds),
    (1e11, Milliseconds),
    (1e8, Seconds),
];
/// Dates without and with a zone.
const DATES: [&str; 4] = [
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y%m%dT%H%M%S%.f",
];
const DATES_WITH_ZONE: [&str; 3] = [
    "%Y-%m-%dT%H:%M:%S%.f%#z",
    "%Y-%m-%d %H:%M:%S%.f%#z",
    "%Y-%m-%d %H:%M:%S%.f %#z",
];

impl TimeUnit {
    /// Returns the unit of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        let known = NAMES.iter().find(|(known, _)| *known == name);
        known.map(|(_, unit)| *unit)
    }

    /// Returns the shortest name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Seconds => "s",
            Milliseconds => "ms",
            Microseconds => "us",
            Nanoseconds => "ns",
            Date => "iso",
        }
    }

    /// Returns the unit that a value shows: a date, or the size of a time since 1970.
    #[must_use]
    pub fn of_value(text: &str, number: Option<f64>) -> Option<Self> {
        if let Some(number) = number {
            let known = SINCE_1970.iter().find(|(least, _)| number >= *least);
            return known.map(|(_, unit)| *unit);
        }
        seconds_of_date(text).map(|_| Date)
    }

    /// Returns the seconds of a cell.
    pub(in super::super) fn seconds(self, text: &str, number: Option<f64>) -> Option<f64> {
        let per_second = match self {
            Date => return seconds_of_date(text),
            Seconds => 1.0,
            Milliseconds => 1e3,
            Microseconds => 1e6,
            Nanoseconds => 1e9,
        };
        number.map(|number| number / per_second)
    }
}

/// Returns the seconds since 1970 of a date; `None` if the text is none.
fn seconds_of_date(text: &str) -> Option<f64> {
    let text = text
        .trim()
        .trim_end_matches("UTC")
        .trim_end()
        .replace(',', ".");
    let text = text.trim_end_matches(['Z', 'z']);
    let plain = DATES
        .iter()
        .find_map(|format| NaiveDateTime::parse_from_str(text, format).ok());
    let micros = plain
        .map(|date| date.and_utc().timestamp_micros())
        .or_else(|| {
            let zoned = DATES_WITH_ZONE
                .iter()
                .find_map(|format| DateTime::parse_from_str(text, format).ok());
            zoned.map(|date| date.timestamp_micros())
        })?;
    Some(micros as f64 / 1e6)
}
