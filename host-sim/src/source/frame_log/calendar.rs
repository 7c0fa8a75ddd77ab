//! Dates of logs, in microseconds since the Unix epoch.

use chrono::NaiveDate;

/// A day and a time of day, without a time zone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct DateTime {
    pub year: u64,
    /// From 1.
    pub month: u64,
    /// From 1.
    pub day: u64,
    pub hour: u64,
    pub minute: u64,
    pub second: u64,
    pub micros: u64,
}

impl DateTime {
    /// Returns the microseconds since the Unix epoch; `None` before it, and for what is no date.
    pub(super) fn unix_micros(&self) -> Option<u64> {
        let small = |number: u64| u32::try_from(number).ok();
        let year = i32::try_from(self.year).ok()?;
        let date = NaiveDate::from_ymd_opt(year, small(self.month)?, small(self.day)?)?;
        let (hour, minute) = (small(self.hour)?, small(self.minute)?);
        let (second, micros) = (small(self.second)?, small(self.micros)?);
        let time = date.and_hms_micro_opt(hour, minute, second, micros)?;
        u64::try_from(time.and_utc().timestamp_micros()).ok()
    }
}
