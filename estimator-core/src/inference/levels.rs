//! Levels: one number a drive for each noise, its learned over its assumed variance.

use crate::scalar::Scalar;
use crate::tuning::Numbers;

macro_rules! levels {
    ($($(#[$about:meta])* $name:ident: $low:ident, $high:ident;)*) => {
        /// Learned over assumed variances.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct Levels {
            $($(#[$about])* pub $name: f32,)*
        }

        /// The sums behind the levels.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct LevelSums {
            $($(#[$about])* pub $name: LevelSum,)*
        }

        impl Levels {
            /// Nothing learned.
            pub const ONE: Self = Self { $($name: 1.0,)* };

            /// Returns sums that count for so many cells, and of which these levels follow.
            #[must_use]
            pub fn sums(&self, cells: f32) -> LevelSums {
                LevelSums { $($name: LevelSum::of(self.$name, cells),)* }
            }
        }

        impl LevelSums {
            /// Nothing learned.
            pub const NONE: Self = Self { $($name: LevelSum::NONE,)* };

            /// Returns the levels that follow from the sums.
            #[must_use]
            pub fn levels(&self, numbers: &Numbers) -> Levels {
                Levels {
                    $($name: self.$name.level(numbers.level_weight, numbers.$low, numbers.$high),)*
                }
            }

            /// Returns the sums of both, of which these count for a fraction.
            #[must_use]
            pub fn decayed_plus(&self, kept: f32, other: &Self) -> Self {
                Self { $($name: self.$name.decayed_plus(kept, other.$name),)* }
            }
        }
    };
}

levels! {
    /// White noise of the force.
    force: level_low, level_high;
    /// Change of the slope rate.
    road: road_level_low, road_level_high;
    /// Slow GNSS error.
    slow_gnss: slow_gnss_level_low, level_high;
    /// Fast GNSS error.
    fast_gnss: level_low, level_high;
    /// White noise of a fix.
    altitude: level_low, level_high;
    /// Noise of a slope that is measured directly.
    slope: level_low, level_high;
    /// Noise of the speed.
    speed: level_low, level_high;
}

/// A sum of normalised squares, and how many of them the data determine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelSum {
    /// Σ q² ρ² over the assumed variance.
    pub squares: f32,
    /// Σ q n.
    pub determined: f32,
}

impl LevelSum {
    const NONE: Self = Self {
        squares: 0.0,
        determined: 0.0,
    };

    /// Adds a term to both sums.
    #[inline(always)]
    pub fn add(&mut self, squares: f32, determined: f32) {
        self.squares += squares;
        self.determined += determined;
    }

    fn of(level: f32, cells: f32) -> Self {
        Self {
            squares: level * cells,
            determined: cells,
        }
    }

    fn level(self, weight: f32, low: f32, high: f32) -> f32 {
        let level = (weight + self.squares) / (weight + self.determined);
        Scalar::min(high, Scalar::max(low, level))
    }

    fn decayed_plus(self, kept: f32, other: Self) -> Self {
        Self {
            squares: kept * self.squares + other.squares,
            determined: kept * self.determined + other.determined,
        }
    }
}
