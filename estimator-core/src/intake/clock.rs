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
    /// Silence after which one input alone does not move the time, µs. A copy of the tuning in 32
    /// bits: every frame is compared with it.
    far_ahead_us: u32,
    /// Time stamp of the newest input that was in time, by the receiver's clock.
    stamp: Instant,
    /// By how much the receiver's clock is behind since it was set back, µs.
    behind_us: u64,
    anomaly: Anomaly,
}

impl Clock {
    /// Creates the clock before the first input.
    pub(super) fn new(tuning: &HoldTimes) -> Self {
        Self {
            far_ahead_us: tuning.start.short_micros(),
            stamp: Instant::ZERO,
            behind_us: 0,
            anomaly: Anomaly::NoInput,
        }
    }

    /// Returns the time of the newest input that was in time.
    pub(super) const fn now(&self) -> Instant {
        self.time_of(self.stamp)
    }

    /// Returns the time of a time stamp.
    const fn time_of(&self, stamp: Instant) -> Instant {
        Instant::from_micros(stamp.micros().wrapping_add(self.behind_us))
    }

    /// Advances to the time stamp of an input, and returns what it means.
    #[inline]
    pub(super) fn advance(&mut self, stamp: Instant, tuning: &HoldTimes) -> TimeCheck {
        // A stamp before the newest one wraps to one very far ahead. Stamps are compared and not
        // times, which need one more addition.
        let since_us = stamp.micros().wrapping_sub(self.stamp.micros());
        if u32::try_from(since_us).is_ok_and(|us| us <= self.far_ahead_us) {
            self.stamp = stamp;
            self.anomaly = Anomaly::None;
            return TimeCheck::Follows;
        }
        self.out_of_time(stamp, tuning.agreement)
    }

    #[inline(never)] // Not on the path of every frame.
    fn out_of_time(&mut self, stamp: Instant, set_back: Duration) -> TimeCheck {
        let (now, time) = (self.now(), self.time_of(stamp));
        if self.anomaly == Anomaly::NoInput {
            self.stamp = stamp;
            self.anomaly = Anomaly::None;
            TimeCheck::Follows
        } else if time >= now {
            let confirmed = matches!(self.anomaly, Anomaly::Ahead(before) if time >= before);
            if !confirmed {
                self.anomaly = Anomaly::Ahead(time);
                return TimeCheck::FarAhead;
            }
            self.stamp = stamp;
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
            self.stamp = stamp;
            self.anomaly = Anomaly::None;
            TimeCheck::SetBack
        }
    }
}
