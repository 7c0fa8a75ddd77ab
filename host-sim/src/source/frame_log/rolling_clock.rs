//! Times that lack their upper part: hours without a day, seconds without an hour.

use chrono::Datelike;
use chrono::{DateTime as Utc, Months};

/// Microseconds of a day.
pub(super) const DAY_US: i64 = 86_400_000_000;

/// Puts such times behind one another: each is the one nearest to the time before, so that midnight and
/// the end of an hour or a month are no steps.
#[derive(Default)]
pub(super) struct RollingClock {
    newest_us: Option<i64>,
    /// True before the first time: it is not much earlier than the start, but may be much later.
    is_start: bool,
}

impl RollingClock {
    /// Creates the clock of a log that was begun at this time, in microseconds since the Unix epoch.
    pub(super) const fn from_start(micros: i64) -> Self {
        Self {
            newest_us: Some(micros),
            is_start: true,
        }
    }

    /// Returns a time that is known but for whole periods.
    pub(super) fn within(&mut self, micros: i64, period_us: i64) -> i64 {
        let mut newest = self.newest_us.unwrap_or(micros);
        if self.is_start {
            newest += period_us / 24 * 11;
        }
        let half = period_us / 2;
        let ahead = (micros - newest + half).rem_euclid(period_us) - half;
        self.set(newest + ahead)
    }

    /// Returns a time that is known but for whole months (or so many of them). The candidate is any such
    /// time; without a time before, it is the one.
    pub(super) fn within_months(&mut self, candidate_us: i64, months: u32) -> i64 {
        let Some(newest) = self.newest_us else {
            return self.set(candidate_us);
        };
        let date = |micros| Utc::from_timestamp_micros(micros);
        let nearest = date(candidate_us).zip(date(newest)).and_then(|(from, to)| {
            let apart = 12 * (to.year() - from.year()) + to.month() as i32 - from.month() as i32;
            let steps = apart.div_euclid(months as i32);
            let moved = (steps - 1..=steps + 1).filter_map(|step| {
                let months = Months::new(step.unsigned_abs() * months);
                let moved = if step < 0 {
                    from.checked_sub_months(months)
                } else {
                    from.checked_add_months(months)
                };
                // Not the last day of a shorter month.
                let moved = moved.filter(|moved| moved.day() == from.day());
                moved.map(|moved| moved.timestamp_micros())
            });
            moved.min_by_key(|moved| moved.abs_diff(newest))
        });
        self.set(nearest.unwrap_or(candidate_us))
    }

    const fn set(&mut self, micros: i64) -> i64 {
        self.newest_us = Some(micros);
        self.is_start = false;
        micros
    }
}
