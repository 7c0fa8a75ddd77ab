//! The number the filter computes in: one source for `f32`, `f64` and fixed point.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

#[cfg(feature = "fixed")]
mod fixed_point;

#[cfg(feature = "fixed")]
pub use fixed_point::FixedPoint;

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
    /// Whether variances can be inferred with it. Their scores span more decades than a fixed-point
    /// number holds: with one, the filter runs on assumed variances, and the lagged grade is the live
    /// one.
    const INFERS: bool;

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

    /// None of them infinite or "not a number", nor their sum.
    fn are_finite(values: &[Self]) -> bool {
        values.iter().all(|value| value.is_finite())
    }

    /// None of them below zero.
    fn are_positive(values: &[Self]) -> bool {
        values.iter().all(|value| *value >= Self::ZERO)
    }

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

    /// `sums += factor * others`, element by element: what nearly all of a filter's work is.
    #[inline(always)]
    fn add_products(sums: &mut [Self], factor: Self, others: &[Self]) {
        for (sum, other) in sums.iter_mut().zip(others) {
            sum.add_product(factor, other);
        }
    }

    /// `self += factor * other`.
    #[inline(always)]
    fn add_product(&mut self, factor: Self, other: &Self) {
        *self += factor * *other;
    }

    /// Sum of the products of two lists.
    #[inline(always)]
    #[must_use]
    fn dot<const N: usize>(a: &[Self; N], b: &[Self; N]) -> Self {
        let mut sum = Self::ZERO;
        for (a, b) in a.iter().zip(b) {
            sum += *a * *b;
        }
        sum
    }
}

macro_rules! float_scalar {
    ($float:ty, $sqrt:path) => {
        impl Scalar for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFERS: bool = true;

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
                $sqrt(self)
            }

            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }

            #[inline]
            fn are_finite(values: &[Self]) -> bool {
                // A sum with one that is not is none: without a branch for each.
                values.iter().sum::<Self>().is_finite()
            }

            #[inline]
            fn are_positive(values: &[Self]) -> bool {
                let none = Self::ZERO.to_bits();
                let signs = values
                    .iter()
                    .fold(none, |signs, value| signs | value.to_bits());
                Self::from_bits(signs).is_sign_positive()
            }
        }
    };
}

/// Square root by Heron's rule, to the last digit or the one before; zero of a number that has none.
///
/// The float unit of a controller has an instruction for it, but `core` does not offer that yet;
/// libm's function, to the last digit always, takes five times as long.
#[inline(never)] // Roots are taken in two dozen places.
fn heron(square: f32) -> f32 {
    if square == f32::INFINITY {
        return square;
    }
    if square <= 0.0 || square.is_nan() {
        return 0.0;
    }
    // Half the exponent: off by 4 % at most, which each turn squares, and halves.
    let mut root = f32::from_bits((square.to_bits() >> 1) + 0x1fbd_1df5);
    for _ in 0..3 {
        root = 0.5 * (root + square / root);
    }
    root
}

/// Square root; of a number that has none, zero.
#[inline]
fn root(square: f64) -> f64 {
    if square > 0.0 {
        libm::sqrt(square)
    } else {
        0.0
    }
}

/// Returns the natural logarithm.
#[inline(never)] // Long, and called from several places.
pub(crate) fn ln(number: f32) -> f32 {
    libm::logf(number)
}

float_scalar!(f32, heron);
float_scalar!(f64, root);

#[cfg(test)]
mod tests {
    use super::heron;

    #[test]
    fn the_root_is_off_by_a_digit_at_most() {
        for exponent in -120..=120 {
            for part in 0..200_u8 {
                let square = (1.0 + f32::from(part) / 100.0) * libm::exp2f(exponent as f32);
                let expected = libm::sqrtf(square);
                let digits = heron(square).to_bits().abs_diff(expected.to_bits());
                assert!(digits <= 1, "{square}: off by {digits}");
            }
        }
        assert_eq!(heron(f32::INFINITY), f32::INFINITY);
        assert!(heron(f32::from_bits(1)) < 1e-18);
    }
}
