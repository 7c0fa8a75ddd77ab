//! Time as an argument: the core never reads a clock.

use core::ops::{Add, Sub};

/// A point in time, in microseconds from any fixed origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Instant {
    micros: u64,
}

/// A span of time, in microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Duration {
    micros: u64,
}

impl Instant {
    /// The origin.
    pub const ZERO: Self = Self { micros: 0 };

    /// From microseconds since the origin.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self { micros }
    }

    /// Microseconds since the origin.
    #[must_use]
    pub const fn micros(self) -> u64 {
        self.micros
    }

    /// Time from `earlier` to `self`; zero if `earlier` is the later one.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Duration {
        Duration {
            micros: self.micros.saturating_sub(earlier.micros),
        }
    }
}

impl Instant {
    /// Seconds from `earlier` to `self`, in f32; zero if `earlier` is the later one.
    #[inline(never)] // Of 64-bit numbers, in many places.
    pub(crate) fn seconds_since(self, earlier: Self) -> f32 {
        self.since(earlier).seconds()
    }
}

impl Duration {
    /// From microseconds.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self { micros }
    }

    /// From milliseconds.
    #[must_use]
    pub const fn from_millis(millis: u32) -> Self {
        Self {
            micros: millis as u64 * 1000,
        }
    }

    /// From seconds, to 4,294 s. Nothing below nought.
    #[must_use]
    pub(crate) const fn from_seconds(seconds: f32) -> Self {
        Self {
            micros: (seconds * 1e6) as u32 as u64,
        }
    }

    /// Microseconds.
    #[must_use]
    pub const fn micros(self) -> u64 {
        self.micros
    }

    /// Microseconds, in 32 bits. Spans beyond 4,294 s saturate: nothing in the core looks that far.
    #[must_use]
    pub(crate) const fn short_micros(self) -> u32 {
        if self.micros > u32::MAX as u64 {
            u32::MAX
        } else {
            self.micros as u32
        }
    }

    /// Seconds, in f64.
    #[must_use]
    pub const fn as_secs_f64(self) -> f64 {
        self.micros as f64 * 1e-6
    }

    /// Seconds, in f32. Spans beyond 4,294 s saturate.
    #[must_use]
    pub const fn seconds(self) -> f32 {
        self.short_micros() as f32 * 1e-6
    }
}

impl Add<Duration> for Instant {
    type Output = Self;

    fn add(self, span: Duration) -> Self {
        Self {
            micros: self.micros.saturating_add(span.micros),
        }
    }
}

impl Sub<Duration> for Instant {
    type Output = Self;

    fn sub(self, span: Duration) -> Self {
        Self {
            micros: self.micros.saturating_sub(span.micros),
        }
    }
}
