//! Time that only goes forward, whatever the receiver's clock does.
//!
//! A clock is set, a counter of 32 bits wraps, a time stamp is garbled. An input that is a little
//! late is rejected. So is a single input far ahead of all others: if it counted, all that follow
//! would be late. Where the inputs continue from another time, time continues from where it was.

use crate::time::{Duration, Instant};
use crate::tuning::HoldTimes;

/// The inputs that were out of time last.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Anomaly {
    /// No input was received yet.
    NoInput,
    /// The last input was in time.
    None,
    /// Inputs before the newest one: in order, from a first to a last time.
    Back(Instant, Instant),
    /// One input far ahead.
    Ahead(Instant),
}

/// What the time of an input means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeCheck {
    /// It follows the input before.
    Follows,
    /// It follows, but the clock was set back in between.
    SetBack,
    /// It is far ahead, and so was the input before: a silence, or a jump of the clock.
    Silent,
    /// It is before the input before it.
    Late,
    /// It alone is far ahead of the input before it.
    FarAhead,
}

/// The time of the newest input.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    now: Instant,
    /// By how much the receiver's clock is behind since it was set back, µs.
    behind_us: u64,
    anomaly: Anomaly,
}

impl Clock {
    /// Creates the clock before the first input.
    pub(super) const fn new() -> Self {
        Self {
            now: Instant::ZERO,
            behind_us: 0,
            anomaly: Anomaly::NoInput,
        }
    }

    /// Returns the time of the newest input that was in time.
    pub(super) const fn now(&self) -> Instant {
        self.now
    }

    /// Advances to the time stamp of an input, and returns what it means.
    #[inline]
    pub(super) fn advance(&mut self, stamp: Instant, tuning: &HoldTimes) -> TimeCheck {
        let time = Instant::from_micros(stamp.micros().wrapping_add(self.behind_us));
        // One comparison: a time before now wraps to one very far ahead.
        let since_us = time.micros().wrapping_sub(self.now.micros());
        if since_us <= tuning.clock_far_ahead.micros() {
            self.now = time;
            self.anomaly = Anomaly::None;
            return TimeCheck::Follows;
        }
        self.out_of_time(time, tuning.clock_set_back)
    }

    #[inline(never)] // Not on the path of every frame.
    fn out_of_time(&mut self, time: Instant, set_back: Duration) -> TimeCheck {
        let now = self.now;
        if self.anomaly == Anomaly::NoInput {
            self.now = time;
            self.anomaly = Anomaly::None;
            TimeCheck::Follows
        } else if time >= now {
            let confirmed = matches!(self.anomaly, Anomaly::Ahead(before) if time >= before);
            if !confirmed {
                self.anomaly = Anomaly::Ahead(time);
                return TimeCheck::FarAhead;
            }
            self.now = time;
            self.anomaly = Anomaly::None;
            TimeCheck::Silent
        } else {
            let first = match self.anomaly {
                Anomaly::Back(first, last) if time >= last => first,
                _ => time,
            };
            let since = time.since(first);
            if since < set_back {
                self.anomaly = Anomaly::Back(first, time);
                return TimeCheck::Late;
            }
            self.behind_us = self.behind_us.wrapping_add(now.since(first).micros());
            self.now = now + since;
            self.anomaly = Anomaly::None;
            TimeCheck::SetBack
        }
    }
}
