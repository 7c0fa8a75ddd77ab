//! A fixed-point [`Scalar`], for controllers without a float unit.
//!
//! A word of 64 bits, half of them behind the point (`I32F32` of the crate `fixed`). Numbers are
//! those below 2³⁰ in magnitude; what a word holds beyond is no number, and stays none: as with
//! floats, whatever is computed from it is none either. So no overflow goes unseen:
//! [`Filter::step`](crate::filter::Filter::step) finds it in the state, counts it
//! ([`Counters::restarts`](crate::Counters::restarts)) and starts anew.
//!
//! # Scaling
//!
//! The units of the states ([`crate::filter::state`]) keep all of them near one, so that no state
//! needs a scale of its own. Over simulated drives of 30 km with and without faults of GNSS, in
//! `f64`:
//!
//! | state | unit | largest | its variance, from | to |
//! |---|---|---|---|---|
//! | kinetic energy | m²/s² | 310 | 5e-3 | 0.1, at first 620 |
//! | altitude | m | 70 | 0 | 15,000 after 30 km without GNSS |
//! | slope | % | 4.1 | 4e-3 | 9 |
//! | slope rate | % per m | 0.013 | 1e-5 | 4e-5 |
//! | bias | % | 0.5 | 2e-3 | 0.2 |
//! | wind | % | 0.08 | 7e-4 | 0.02 |
//! | scale | 1 | 0.25 | 5e-4 | 0.01 |
//! | GNSS error | m | 1.8 | 2.8 | 9 |
//!
//! The last bit is 2.3e-10; the least that is ever added to a variance, the scale's wander over a
//! cell, is 43 of them. Nothing in the filter exceeds 1.5e4 and nothing in the smoothing 5e4 (its
//! information is about one over a variance): the least number that is none, 1.1e9, is four
//! decades off. 32 bits would not do: variances span nine decades, and the smoothing needs their
//! inverses in the same number.
//!
//! # Cost
//!
//! The crate's own product of such words goes by way of 128 bits, which takes a controller
//! thousands of instructions a step of the smallest filter; ours takes the parts that are needed of
//! 32 by 32 bits.

use super::Scalar;
use crate::division::upper_product;
use core::cmp::Ordering;
use core::fmt;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};
use fixed::types::I32F32;

/// A number to 2⁻³², below 2³⁰ in magnitude; or none.
#[derive(Clone, Copy)]
pub struct FixedPoint(I32F32);

/// Bits of the first number that is none: 2³⁰. The bit above is for sums of two.
const LIMIT: i64 = 1 << 62;

impl FixedPoint {
    /// Not a number: too large, or nothing over nothing.
    pub const NAN: Self = Self::from_bits(i64::MAX);

    /// That of a word: so many times 2⁻³².
    #[must_use]
    pub const fn from_bits(bits: i64) -> Self {
        Self(I32F32::from_bits(bits))
    }

    /// The word.
    #[must_use]
    pub const fn to_bits(self) -> i64 {
        self.0.to_bits()
    }

    /// Of a magnitude in bits, if it is one of a number.
    fn signed(magnitude: u64, negative: bool) -> Self {
        match i64::try_from(magnitude) {
            Ok(bits) if bits < LIMIT => Self::from_bits(if negative { -bits } else { bits }),
            _ => Self::NAN,
        }
    }
}

impl FixedPoint {
    /// `self += a * b`.
    #[inline(always)]
    fn plus_product(&mut self, a: Self, b: Self) {
        let [sum, a, b] = [*self, a, b].map(Self::to_bits);
        let bits = if any_large([sum, a, b].map(|bits| (bits >> 32) as u32)) {
            self::sum(sum, large_product(a, b))
        } else {
            sum.wrapping_add(small_product(a, b))
        };
        *self = Self::from_bits(bits);
    }
}

/// Whether either is none.
#[inline(always)]
const fn is_none_of(a: i64, b: i64) -> bool {
    (a.wrapping_add(LIMIT) | b.wrapping_add(LIMIT)) < 0
}

/// Bits of the sum. That of two numbers fits, if not always as a number.
#[inline(always)]
const fn sum(a: i64, b: i64) -> i64 {
    none_if(is_none_of(a, b), a.wrapping_add(b))
}

/// The bits, or those of what is none.
#[inline(always)]
const fn none_if(is_none: bool, bits: i64) -> i64 {
    if is_none {
        FixedPoint::NAN.to_bits()
    } else {
        bits
    }
}

/// The half of a word behind the point, and half of its last bit.
const FRACTION: i64 = 0xffff_ffff;
const HALF: u64 = 1 << 31;

/// Half of what is large, in the half of a word before the point: products of less are numbers
/// without a look at them, and so are sums with one.
const SMALL: u32 = 1 << 14;

/// Whether any of these is large, by its half before the point.
#[inline(always)]
fn any_large<const N: usize>(highs: [u32; N]) -> bool {
    let largest = highs
        .iter()
        .fold(0, |largest, high| largest | high.wrapping_add(SMALL));
    largest >= 2 * SMALL
}

/// Bits of the product, rounded to the nearest.
///
/// Not inlined where a word takes two registers: a call is not longer than what would have to be
/// put aside for it, and flash is dear.
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn product(a: i64, b: i64) -> i64 {
    if any_large([(a >> 32) as u32, (b >> 32) as u32]) {
        return large_product(a, b);
    }
    small_product(a, b)
}

/// The same, where neither is large.
#[inline(always)]
const fn small_product(a: i64, b: i64) -> i64 {
    let [a_high, b_high] = [(a >> 32) as u32, (b >> 32) as u32];
    let [a_low, b_low] = [a as u32, b as u32];
    // Of words without a sign, then less what the signs make of it: a controller has an
    // instruction for that.
    let low = wide_product(a_low, b_low);
    let middle = ((low >> 32) + (low as u32 >> 31) as u64)
        .wrapping_add(wide_product(a_low, b_high))
        .wrapping_add(wide_product(a_high, b_low));
    let high = (a_high.wrapping_mul(b_high))
        .wrapping_sub(((a_high as i32) >> 31) as u32 & b_low)
        .wrapping_sub(((b_high as i32) >> 31) as u32 & a_low);
    middle.wrapping_add((high as u64) << 32) as i64
}

/// The whole product.
#[cfg(target_has_atomic = "32")]
#[inline(always)]
const fn wide_product(a: u32, b: u32) -> u64 {
    a as u64 * b as u64
}

/// The whole product. A Cortex-M0, which has no atomics, has no instruction for it either, and
/// the compiler would call for one of 64 by 64 bits.
#[cfg(not(target_has_atomic = "32"))]
#[inline(always)]
const fn wide_product(a: u32, b: u32) -> u64 {
    const LOW: u32 = 0xffff;
    let [a_high, a_low, b_high, b_low] = [a >> 16, a & LOW, b >> 16, b & LOW];
    let low = a_low * b_low;
    let middle = a_high * b_low + (low >> 16);
    let other = a_low * b_high + (middle & LOW);
    let high = a_high * b_high + (middle >> 16) + (other >> 16);
    (high as u64) << 32 | (other << 16 | (low & LOW)) as u64
}

/// The same of any words.
#[cold]
#[inline(never)]
const fn large_product(a: i64, b: i64) -> i64 {
    if is_none_of(a, b) {
        return FixedPoint::NAN.to_bits();
    }
    let [a_high, b_high] = [a >> 32, b >> 32];
    let [a_low, b_low] = [a & FRACTION, b & FRACTION];
    let low = (a_low as u64 * b_low as u64 + HALF) >> 32;
    // Of 2³⁰ times 2³² each, but for the last: they fit.
    let middle = a_high * b_low + a_low * b_high + low as i64;
    let high = a_high * b_high + (middle >> 32);
    if high < -(LIMIT >> 32) || high >= LIMIT >> 32 {
        return FixedPoint::NAN.to_bits();
    }
    (high << 32) | (middle & FRACTION)
}

/// 2¹²⁶ over a number from 2⁶³ on, to about 58 bits: by Newton's rule from a quotient of 16 bits.
const fn reciprocal(of: u64) -> u64 {
    let high = of >> 32;
    // The bit is set: the compiler then knows that this is not zero.
    let first = (u32::MAX / ((of >> 48) as u32 | 0x8000)) as u64;
    let rest = (1_u64 << 49).wrapping_sub(high * first) >> 17;
    // Two over one half would be one more than 32 bits hold, but there `first` is rounded down.
    let second = (first * rest) >> 16;
    let rest = (high * second + (((of & 0xffff_ffff) * second) >> 32)).wrapping_neg();
    (rest >> 32) * second + (((rest & 0xffff_ffff) * second) >> 32)
}

/// Bits of the quotient of two magnitudes in bits, if it is that of a number.
fn quotient(dividend: u64, divisor: u64) -> Option<u64> {
    if divisor == 0 {
        return None;
    }
    if dividend == 0 {
        return Some(0);
    }
    let (up, of) = (dividend.leading_zeros(), divisor.leading_zeros());
    let digits = upper_product(dividend << up, reciprocal(divisor << of));
    // 32 bits behind the point, and back over both shifts and the scale of the reciprocal.
    let down = (30 + up).checked_sub(of)?;
    match down {
        0 => Some(digits),
        1..=63 => Some(((digits >> (down - 1)) + 1) >> 1),
        _ => Some(0),
    }
}

impl Scalar for FixedPoint {
    const ZERO: Self = Self::from_bits(0);
    const ONE: Self = Self::from_bits(1 << 32);
    const INFERS: bool = false;

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn from_f32(value: f32) -> Self {
        const FRACTION: u32 = 23;
        /// Of an f32 whose last bit stands for 2⁻³².
        const EVEN: u32 = 127 + FRACTION - 32;
        let bits = value.to_bits();
        let exponent = (bits >> FRACTION) & 0xff;
        let digits = u64::from((bits & ((1 << FRACTION) - 1)) | (1 << FRACTION));
        let magnitude = if exponent >= EVEN {
            // 39 is what makes the least number that is none.
            digits << (exponent - EVEN).min(39)
        } else {
            // Of those that are too small for a leading one, nothing is left either.
            let down = EVEN - exponent;
            ((digits >> (down - 1).min(63)) + 1) >> 1
        };
        Self::signed(magnitude, value.is_sign_negative())
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn to_f32(self) -> f32 {
        const LAST: f32 = 1.0 / (1_u64 << 32) as f32;
        if !self.is_finite() {
            return f32::NAN;
        }
        // By halves: a controller has instructions for 32 bits. Off by a last digit at most.
        let bits = self.to_bits();
        let magnitude = bits.unsigned_abs();
        let sum = (magnitude >> 32) as u32 as f32 + magnitude as u32 as f32 * LAST;
        if bits < 0 { -sum } else { sum }
    }

    fn to_f64(self) -> f64 {
        if self.is_finite() {
            self.0.to_num()
        } else {
            f64::NAN
        }
    }

    fn from_f64(value: f64) -> Self {
        I32F32::checked_from_num(value).map_or(Self::NAN, Self)
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn sqrt(self) -> Self {
        if !self.is_finite() {
            return Self::NAN;
        }
        Self(self.0.checked_sqrt().unwrap_or(I32F32::ZERO))
    }

    // A sum is looked at once with its products, and its words stay in registers.

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn add_products(sums: &mut [Self], factor: Self, others: &[Self]) {
        for (sum, other) in sums.iter_mut().zip(others) {
            sum.plus_product(factor, *other);
        }
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn add_product(&mut self, factor: Self, other: &Self) {
        self.plus_product(factor, *other);
    }

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn dot<const N: usize>(a: &[Self; N], b: &[Self; N]) -> Self {
        let mut sum = Self::ZERO;
        for (a, b) in a.iter().zip(b) {
            sum.plus_product(*a, *b);
        }
        sum
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.to_bits().wrapping_add(LIMIT) >= 0
    }
}

impl Add for FixedPoint {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::from_bits(sum(self.to_bits(), other.to_bits()))
    }
}

impl Sub for FixedPoint {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.to_bits(), other.to_bits());
        Self::from_bits(none_if(is_none_of(a, b), a.wrapping_sub(b)))
    }
}

impl Mul for FixedPoint {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::from_bits(product(self.to_bits(), other.to_bits()))
    }
}

impl Div for FixedPoint {
    type Output = Self;

    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.to_bits(), other.to_bits());
        if is_none_of(a, b) {
            return Self::NAN;
        }
        quotient(a.unsigned_abs(), b.unsigned_abs())
            .map_or(Self::NAN, |bits| Self::signed(bits, (a ^ b) < 0))
    }
}

impl Neg for FixedPoint {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::from_bits(self.to_bits().wrapping_neg())
    }
}

impl AddAssign for FixedPoint {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for FixedPoint {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for FixedPoint {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl PartialEq for FixedPoint {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

/// As with floats, what is no number is neither less nor more than any.
impl PartialOrd for FixedPoint {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let (a, b) = (self.to_bits(), other.to_bits());
        if is_none_of(a, b) {
            None
        } else {
            Some(a.cmp(&b))
        }
    }
}

impl fmt::Debug for FixedPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_finite() {
            self.0.fmt(f)
        } else {
            f.write_str("NaN")
        }
    }
}
