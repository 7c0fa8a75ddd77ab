//! The thesis's two methods, by name.

use super::drive::{MeasuredDrive, Profile};
use super::modified;
use super::original::{self, NoiseSigmas};

/// A grade estimation method of the thesis, with the noise chosen for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonMethod {
    /// Section 3.
    Original,
    /// Section 8.1.
    Modified,
}

impl ComparisonMethod {
    /// Both methods, in the order of the comparison.
    pub const BOTH: [Self; 2] = [Self::Original, Self::Modified];

    /// Returns the name of the method.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Original => "original",
            Self::Modified => "modified",
        }
    }

    /// Estimates the smoothed grade of a drive.
    #[must_use]
    pub fn estimate(self, drive: &MeasuredDrive) -> Profile {
        match self {
            Self::Original => original::estimate(drive, &NoiseSigmas::ORIGINAL),
            Self::Modified => modified::estimate(drive).profile,
        }
    }
}
