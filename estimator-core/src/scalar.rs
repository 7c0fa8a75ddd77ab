//! The number the filter computes in: one source for `f32`, `f64` and fixed point.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

#[cfg(feature = "fixed")]
mod fixed_point;

#[cfg(feature = "fixed")]
pub use fixed_point::Fixed;

/// What the estimator asks of a number.
///
/// Values are kept near one by the choice of units (grade in %, altitude relative to a local
/// origin), so that a fixed-point number of moderate width can serve.
pub trait Scalar:
    Copy
    + Debug
    + PartialOrd
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Nought.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The nearest number to `value`. Signals and parameters come in `f32`.
    fn from_f32(value: f32) -> Self;
    /// The nearest `f32`.
    fn to_f32(self) -> f32;
    /// The nearest `f64`; for hosts.
    fn to_f64(self) -> f64;
    /// The nearest number to a host's `value`.
    fn from_f64(value: f64) -> Self;
    /// Square root; of a negative number, zero.
    fn sqrt(self) -> Self;
    /// Neither infinite nor "not a number".
    fn is_finite(self) -> bool;

    /// The larger of two.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// The smaller of two.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The square.
    #[must_use]
    fn squared(self) -> Self {
        self * self
    }
}

macro_rules! float_scalar {
    ($float:ty, $sqrt:path) => {
        impl Scalar for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            #[inline]
            fn from_f32(value: f32) -> Self {
                value as Self
            }

            #[inline]
            fn to_f32(self) -> f32 {
                self as f32
            }

            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline]
            fn sqrt(self) -> Self {
                if self > 0.0 { $sqrt(self) } else { 0.0 }
            }

            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

float_scalar!(f32, libm::sqrtf);
float_scalar!(f64, libm::sqrt);
