//! The times of a signal table, whether it is CSV or Parquet.

use super::frame_log::{Seconds, moved_to_zero};
use estimator_core::Instant;

/// Beyond this many seconds `f64` does not resolve microseconds well.
const LATEST_S: f64 = 4e9;
/// What is expected of a time.
pub(super) const EXPECTED: &str = "seconds from -4e9 to 4e9";

/// Times so far. Where the first one is negative, all are moved to begin with zero.
#[derive(Debug, Default)]
pub(super) struct TableClock {
    first_us: Option<i64>,
    /// The time that was asked for last, µs.
    asked_us: i64,
    newest: Instant,
}

/// Why a row has no time.
pub(super) enum NoTime {
    /// It is missing, or beyond all measurements.
    Wrong,
    /// Neither the header nor the value shows its unit.
    NoUnit,
    /// It is before that of the row above: the problem in words.
    Backwards(String),
}

impl TableClock {
    /// Returns the time of a row.
    ///
    /// # Errors
    /// Returns why it has none.
    pub(super) fn time(&mut self, seconds: Option<f64>) -> Result<Instant, NoTime> {
        let seconds = seconds.filter(|seconds| seconds.abs() < LATEST_S);
        let micros = (seconds.ok_or(NoTime::Wrong)? * 1e6).round() as i64;
        self.asked_us = micros;
        let first_us = self.first_us.unwrap_or(micros).min(0);
        let backwards = || {
            let newest_us = self.newest.micros() as i64 + first_us;
            let (newest, time) = (Seconds(newest_us), Seconds(micros));
            NoTime::Backwards(format!("time_s runs backwards, from {newest} to {time}"))
        };
        let time = u64::try_from(micros - first_us).map_err(|_| backwards())?;
        let time = Instant::from_micros(time);
        if time < self.newest {
            return Err(backwards());
        }
        Ok(time)
    }

    /// Takes the time that was returned last: its row counts.
    pub(super) fn take(&mut self, time: Instant) {
        self.first_us.get_or_insert(self.asked_us);
        self.newest = time;
    }

    /// Returns what was done to the times, in words.
    pub(super) fn mended(&self) -> Vec<String> {
        moved_to_zero(self.first_us).into_iter().collect()
    }
}
