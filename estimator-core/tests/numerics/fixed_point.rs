//! The fixed-point number against whole numbers of 128 bits, and against floats.

use estimator_core::{FixedPoint, Scalar};
use proptest::prelude::*;

/// Bits of the smallest positive value that is out of range.
const LIMIT: i64 = 1 << 62;
/// Bits of one.
const ONE: i128 = 1 << 32;

/// Words of every size, with both signs.
fn word() -> impl Strategy<Value = i64> {
    (any::<i64>(), 1..63_u32).prop_map(|(bits, shift)| bits >> shift)
}

fn number(bits: i64) -> FixedPoint {
    FixedPoint::from_bits(bits)
}

/// Returns the bits of a number; `None` for NaN.
fn bits(number: FixedPoint) -> Option<i64> {
    number.is_finite().then(|| number.to_bits())
}

/// Returns exact bits, if they are within the range of numbers.
fn exact(bits: i128) -> Option<i64> {
    let limit = i128::from(LIMIT);
    (-limit..limit).contains(&bits).then_some(bits as i64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn sums_are_exact_or_nan(a in word(), b in word()) {
        let (wide_a, wide_b) = (i128::from(a), i128::from(b));
        prop_assert_eq!(bits(number(a) + number(b)), exact(wide_a + wide_b));
        prop_assert_eq!(bits(number(a) - number(b)), exact(wide_a - wide_b));
        prop_assert_eq!(bits(-number(a)), exact(-wide_a));
        let mut sum = number(a);
        sum += number(b);
        sum -= number(a);
        if exact(wide_a + wide_b).is_some() {
            prop_assert_eq!(bits(sum), Some(b));
        } else {
            prop_assert!(!sum.is_finite(), "NaN stays NaN");
        }
    }

    #[test]
    fn products_are_the_nearest_number_or_nan(a in word(), b in word()) {
        // One half is rounded up, for both signs.
        let nearest = (i128::from(a) * i128::from(b) + ONE / 2) >> 32;
        prop_assert_eq!(bits(number(a) * number(b)), exact(nearest));
        let mut product = number(a);
        product *= number(b);
        prop_assert_eq!(bits(product), exact(nearest));
    }

    #[test]
    fn quotients_are_right_to_the_last_bit_or_56(a in word(), b in word()) {
        let quotient = number(a) / number(b);
        if b == 0 {
            prop_assert!(!quotient.is_finite());
        } else {
            let nearest = i128::from(a) * ONE / i128::from(b);
            let allowed = 1 + (nearest.abs() >> 56);
            match bits(quotient) {
                Some(found) => prop_assert!((i128::from(found) - nearest).abs() <= allowed),
                None => prop_assert!(nearest.abs() + allowed >= i128::from(LIMIT)),
            }
        }
    }

    #[test]
    fn roots_are_right_to_the_last_bit(a in word()) {
        let root = bits(number(a).sqrt());
        if a <= 0 {
            prop_assert_eq!(root, Some(0));
        } else {
            let square = i128::from(a) * ONE;
            let root = i128::from(root.unwrap());
            prop_assert!((root - 1).pow(2) <= square && square <= (root + 1).pow(2));
        }
    }

    #[test]
    fn order_is_that_of_numbers(a in word(), b in word()) {
        prop_assert_eq!(number(a).partial_cmp(&number(b)), a.partial_cmp(&b));
        prop_assert_eq!(number(a) == number(b), a == b);
        prop_assert_eq!(bits(number(a).max(number(b))), Some(a.max(b)));
        prop_assert_eq!(bits(number(a).min(number(b))), Some(a.min(b)));
        prop_assert_eq!(bits(number(a).abs()), exact(i128::from(a).abs()));
    }

    #[test]
    fn floats_come_in_to_the_last_bit_and_go_out_to_a_digit(value in any::<f32>(), a in word()) {
        let wide = f64::from(value) * ONE as f64;
        for found in [FixedPoint::from_f32(value), FixedPoint::from_f64(value.into())] {
            match bits(found) {
                Some(found) => prop_assert!((found as f64 - wide).abs() <= 0.5),
                None => prop_assert!(wide.is_nan() || wide.abs() >= LIMIT as f64),
            }
        }
        let nearest = (a as f64 / ONE as f64) as f32;
        prop_assert!(number(a).to_f32().to_bits().abs_diff(nearest.to_bits()) <= 1);
        prop_assert_eq!(number(a).to_f64(), a as f64 / ONE as f64);
    }

    #[test]
    fn sums_of_products_are_those_of_their_parts(
        a in prop::array::uniform4(word()), b in prop::array::uniform4(word()), factor in word(),
    ) {
        let (a, b, factor) = (a.map(number), b.map(number), number(factor));
        let one_by_one = |sum: FixedPoint, (a, b): (&FixedPoint, &FixedPoint)| sum + *a * *b;
        let sum = a.iter().zip(&b).fold(FixedPoint::ZERO, one_by_one);
        prop_assert_eq!(bits(FixedPoint::dot(&a, &b)), bits(sum));
        let mut sums = a;
        FixedPoint::add_products(&mut sums, factor, &b);
        for ((sum, a), b) in sums.iter().zip(a).zip(b) {
            prop_assert_eq!(bits(*sum), bits(a + factor * b));
            let mut same = a;
            same.add_product(factor, &b);
            prop_assert_eq!(bits(same), bits(*sum));
        }
    }

    #[test]
    fn nan_propagates(a in word()) {
        let (nan, some) = (FixedPoint::NAN, number(a));
        for computed in [
            nan + some, some + nan, nan - some, some - nan, nan - nan, nan + nan,
            nan * some, some * nan, nan * nan, nan / some, some / nan, -nan,
            nan.sqrt(), nan.max(some), nan.abs(), nan.squared(),
        ] {
            prop_assert!(!computed.is_finite());
            prop_assert!(computed.to_f32().is_nan() && computed.to_f64().is_nan());
        }
        prop_assert!(nan.partial_cmp(&some).is_none() && nan != nan);
    }
}

#[test]
fn known_numbers() {
    assert_eq!(FixedPoint::from_f32(-1.5).to_bits(), -(3 << 31));
    assert_eq!(
        (FixedPoint::ONE + FixedPoint::ONE).sqrt().to_f32(),
        2.0_f32.sqrt()
    );
    assert_eq!(
        (FixedPoint::ONE / FixedPoint::from_f32(3.0)).to_bits(),
        (1 << 32) / 3
    );
    assert_eq!(FixedPoint::from_f32(f32::MIN_POSITIVE), FixedPoint::ZERO);
    for outside in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1_073_741_824.0] {
        assert!(!FixedPoint::from_f32(outside).is_finite(), "{outside}");
        assert!(
            !FixedPoint::from_f64(outside.into()).is_finite(),
            "{outside}"
        );
    }
    assert_eq!(
        format!("{:?} {:?}", FixedPoint::from_f32(-0.25), FixedPoint::NAN),
        "-0.25 NaN"
    );
}
