//! Time stamps that continue when the system clock is set.
//!
//! The kernel stamps frames with the time of day. A truck's computer often starts in 1970 and gets
//! the time from its GNSS receiver minutes later. If a clock is set back, every frame is older than
//! the one before it until the old time is reached again.

use estimator_core::Instant;
use std::time::{Duration, Instant as Monotonic, SystemTime, UNIX_EPOCH};

/// Smallest clock change that counts. Reading both clocks takes microseconds.
const LEAST_CHANGE: Duration = Duration::from_millis(20);

/// Both clocks, read one after the other.
#[derive(Clone, Copy, Debug)]
pub struct ClockReading {
    /// The clock that is never set, read first.
    pub monotonic: Monotonic,
    /// The system clock.
    pub of_day: SystemTime,
    /// Longest time between the two readings. The thread may have to wait for the processor
    /// between them.
    pub apart: Duration,
}

impl ClockReading {
    /// Reads both clocks.
    #[must_use]
    pub fn now() -> Self {
        let monotonic = Monotonic::now();
        let of_day = SystemTime::now();
        Self {
            monotonic,
            of_day,
            apart: monotonic.elapsed(),
        }
    }
}

/// Converts time stamps of the system clock to times without steps.
#[derive(Clone, Debug)]
pub struct SteadyClock {
    start: Monotonic,
    start_of_day: SystemTime,
    /// Sum of the clock changes since the start, µs.
    set_by_micros: i64,
}

impl SteadyClock {
    /// Starts with the current clock.
    #[must_use]
    pub fn new(now: ClockReading) -> Self {
        Self {
            start: now.monotonic,
            start_of_day: now.of_day,
            set_by_micros: 0,
        }
    }

    /// Compares both clocks. Returns true if the system clock was set since the last call. A change
    /// no larger than the time between the two readings is left to the next call.
    pub fn check(&mut self, now: ClockReading) -> bool {
        let expected = self.start_of_day + now.monotonic.duration_since(self.start);
        let set_by = micros_between(expected, now.of_day);
        let least = LEAST_CHANGE + now.apart;
        let is_set = set_by.abs_diff(self.set_by_micros) > least.as_micros() as u64;
        if is_set {
            self.set_by_micros = set_by;
        }
        is_set
    }

    /// Returns the steady time of a stamp that was read at `now`: the system time as if the clock
    /// had never been set.
    #[must_use]
    pub fn time(&self, stamp: SystemTime, now: Monotonic) -> Instant {
        let since_epoch = micros_between(UNIX_EPOCH, stamp).saturating_sub(self.set_by_micros);
        let latest = self.start_of_day + now.duration_since(self.start);
        let latest = micros_between(UNIX_EPOCH, latest).max(0) as u64;
        // A stamp from the moment of the change may be of either time.
        Instant::from_micros((since_epoch.max(0) as u64).min(latest))
    }
}

fn micros_between(from: SystemTime, to: SystemTime) -> i64 {
    match to.duration_since(from) {
        Ok(forward) => forward.as_micros() as i64,
        Err(backward) => -(backward.duration().as_micros() as i64),
    }
}
