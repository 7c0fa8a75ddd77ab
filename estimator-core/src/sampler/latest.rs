//! The newest value of a signal, with its time.

use crate::maybe::Maybe;
use crate::time::{Duration, Instant};

/// A value and its time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedValue {
    pub value: f32,
    pub time: Instant,
}

/// The newest value of a signal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Latest {
    value: Maybe,
    time: Instant,
}

impl Latest {
    /// Takes a reading: a value, or `None` for "not available".
    pub(super) fn set(&mut self, value: Option<f32>, time: Instant) {
        *self = Self {
            value: value.into(),
            time,
        };
    }

    /// Takes a reading of a switch: "not available" leaves the last value until it is stale. A brake
    /// that was pressed when its sensor failed is not released by that.
    pub(super) fn set_if_available(&mut self, value: Option<f32>, time: Instant) {
        if value.is_some() {
            self.set(value, time);
        }
    }

    /// Returns the value, whatever its age.
    pub(super) fn last(&self) -> Option<f32> {
        self.value.get()
    }

    /// Returns the value if it is no older than `age`.
    #[inline(never)] // Of 64-bit numbers, in dozens of places.
    pub(super) fn within(&self, now: Instant, age: Duration) -> Option<f32> {
        self.within_inlined(now, age)
    }

    /// Does the same where frame after frame asks.
    #[inline(always)]
    pub(super) fn within_inlined(&self, now: Instant, age: Duration) -> Option<f32> {
        // Not by its own age: the oldest time is the same for all signals that are read at once.
        self.value.get().filter(|_| self.time >= now - age)
    }

    /// Returns the value with its age.
    pub(super) fn with_age(&self, now: Instant) -> Option<(f32, Duration)> {
        self.value.get().map(|value| (value, now.since(self.time)))
    }

    /// Returns whether a switch is on, by a value no older than `age`.
    #[inline(never)] // Called from several places.
    pub(super) fn is_on(&self, now: Instant, age: Duration) -> bool {
        self.passes(now, age, |value| value > 0.5)
    }

    /// Returns whether a value no older than `age` passes a test.
    #[inline(always)]
    pub(super) fn passes(&self, now: Instant, age: Duration, test: impl Fn(f32) -> bool) -> bool {
        // The age last: most values fail the test, and times have 64 bits.
        self.value.get().is_some_and(test) && self.time >= now - age
    }
}
