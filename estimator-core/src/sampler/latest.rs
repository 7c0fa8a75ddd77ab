//! The newest value of a signal, and how long it may be believed.

use crate::maybe::Maybe;
use crate::time::{Duration, Instant};

/// A gear, a switch or a quality figure older than this is forgotten.
const STATE_STALE: Duration = Duration::from_millis(5_000);

/// A value and when it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timed {
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
    /// A reading: a value, or the news that there is none.
    pub(super) fn set(&mut self, value: Option<f32>, time: Instant) {
        *self = Self {
            value: value.into(),
            time,
        };
    }

    /// A reading of a switch: where there is none, the last one stands until it is stale. A brake
    /// that was pressed when its sensor failed is not released by that.
    pub(super) fn keep(&mut self, value: Option<f32>, time: Instant) {
        if value.is_some() {
            self.set(value, time);
        }
    }

    /// Whatever its age.
    pub(super) fn last(&self) -> Option<f32> {
        self.value.get()
    }

    /// If it is no older than `age`.
    #[inline]
    pub(super) fn within(&self, now: Instant, age: Duration) -> Option<f32> {
        // Not by its own age: the oldest time is the same for all that are asked at once.
        self.value.get().filter(|_| self.time >= now - age)
    }

    /// With its age.
    pub(super) fn since(&self, now: Instant) -> Option<(f32, Duration)> {
        self.value.get().map(|value| (value, now.since(self.time)))
    }

    /// Of a state that holds until it is told otherwise, if its sender is still heard.
    pub(super) fn state(&self, now: Instant) -> Option<f32> {
        self.within(now, STATE_STALE)
    }

    /// Of a switch.
    pub(super) fn is_on(&self, now: Instant) -> bool {
        self.state(now).is_some_and(|value| value > 0.5)
    }
}
