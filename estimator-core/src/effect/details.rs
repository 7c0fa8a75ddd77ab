//! What an effect depends on besides its amount.

use crate::maybe::Maybe;
use crate::vehicle::{ParameterError, check};

/// Most details that an effect has.
pub const MAX_DETAILS: usize = 3;

/// Values in the order of [`Effect::details`](super::Effect::details); none is absent.
pub type Details = [Maybe; MAX_DETAILS];

/// A further number of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Key in the vehicle file, with its unit.
    pub key: &'static str,
    /// What it is, and what its absence means.
    pub about: &'static str,
    /// Value where none is given; none stays absent.
    pub default: Maybe,
    /// Values that can be.
    pub range: Bounds,
}

/// A range, and how it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest.
    pub low: f32,
    /// Largest.
    pub high: f32,
    /// In words, with the unit.
    pub words: &'static str,
}

impl Bounds {
    /// From `low` to `high`.
    #[must_use]
    pub const fn new(low: f32, high: f32, words: &'static str) -> Self {
        Self { low, high, words }
    }

    /// Whether a value is within.
    #[must_use]
    pub fn holds(self, value: f32) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Checks that a value is within.
    ///
    /// # Errors
    /// If not, or if it is no number.
    pub(super) fn check(self, key: &'static str, value: f32) -> Result<(), ParameterError> {
        check(key, value, self.low, self.high, self.words)
    }
}
