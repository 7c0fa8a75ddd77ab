//! A number that may not be known, in four bytes.

use core::fmt;

/// A number, or none. An `Option<f32>` takes twice as much, and dozens of samples with several of
/// these wait for the filter.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Option<f32>", into = "Option<f32>"))]
pub struct Maybe(f32);

impl Maybe {
    /// Not known.
    pub const NONE: Self = Self(f32::NAN);

    /// This number; none if it is not a number.
    #[must_use]
    pub const fn some(number: f32) -> Self {
        Self(number)
    }

    /// The number, if there is one.
    #[must_use]
    pub const fn get(self) -> Option<f32> {
        if self.0.is_nan() { None } else { Some(self.0) }
    }
}

impl Default for Maybe {
    fn default() -> Self {
        Self::NONE
    }
}

impl From<Option<f32>> for Maybe {
    fn from(number: Option<f32>) -> Self {
        number.map_or(Self::NONE, Self::some)
    }
}

impl From<Maybe> for Option<f32> {
    fn from(number: Maybe) -> Self {
        number.get()
    }
}

/// As the options: none is none.
impl PartialEq for Maybe {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}

impl fmt::Debug for Maybe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.get().fmt(f)
    }
}
