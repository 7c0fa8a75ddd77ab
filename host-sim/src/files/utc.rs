//! Absolute time.

use chrono::DateTime;
use estimator_core::Instant;

/// Earliest absolute time of a log, µs: 2001-09-09. Smaller times count from a start that no one
/// knows.
const EARLIEST_MICROS: u64 = 1_000_000_000_000_000;

/// Returns the time of a log in UTC as RFC 3339 writes it (`2026-11-22T17:30:00.250Z`), if the time
/// stamps of the log are absolute: seconds since 1970, as candump writes them.
#[must_use]
pub fn utc_of(time: Instant) -> Option<String> {
    Some(time.micros())
        .filter(|micros| *micros >= EARLIEST_MICROS)
        .and_then(utc_text)
}

/// Returns a time, in microseconds since 1970, as RFC 3339 writes it.
#[must_use]
pub fn utc_text(unix_micros: u64) -> Option<String> {
    let utc = DateTime::from_timestamp_micros(i64::try_from(unix_micros).ok()?)?;
    Some(format!("{utc:?}"))
}

/// Returns the seconds since 1970 of a time as RFC 3339 writes it.
#[must_use]
pub fn unix_seconds(utc: &str) -> Option<f64> {
    let time = DateTime::parse_from_rfc3339(utc).ok()?;
    Some(time.timestamp_micros() as f64 * 1e-6)
}
