//! The packed symmetric matrix against nalgebra's dense one.

use estimator_core::filter::{Covariance, STATES, StateIndex, StateVector};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;

type Dense = SMatrix<f64, STATES, STATES>;
type Elements = Vec<f64>;

/// Returns the state with this position.
fn state(position: usize) -> StateIndex {
    StateIndex::ALL[position]
}

fn elements(count: usize) -> impl Strategy<Value = Elements> {
    prop::collection::vec(-2.0..2.0_f64, count)
}

fn vector(elements: &[f64]) -> StateVector<f64> {
    std::array::from_fn(|i| elements[i])
}

/// Returns a positive definite matrix.
fn positive(numbers: &[f64]) -> Covariance<f64> {
    let root = Dense::from_fn(|i, j| numbers[i * STATES + j]);
    let product = root * root.transpose() + Dense::identity() * 1e-3;
    let mut covariance = Covariance::ZERO;
    for i in 0..STATES {
        for j in i..STATES {
            covariance.add(state(i), state(j), product[(i, j)]);
        }
    }
    covariance
}

fn dense(covariance: &Covariance<f64>) -> Dense {
    Dense::from_fn(|i, j| covariance.get(state(i), state(j)))
}

fn close(a: &Dense, b: &Dense) -> bool {
    (a - b).amax() <= 1e-9 * (1.0 + b.amax())
}

proptest! {
    #[test]
    fn shear_is_a_congruence(
        numbers in elements(STATES * STATES),
        i in 0..STATES, step in 1..STATES, factor in -3.0..3.0_f64,
    ) {
        let j = (i + step) % STATES;
        let mut packed = positive(&numbers);
        let before = dense(&packed);
        packed.shear(state(i), state(j), factor);
        let mut f = Dense::identity();
        f[(i, j)] = factor;
        prop_assert!(close(&dense(&packed), &(f * before * f.transpose())));
    }

    #[test]
    fn scale_is_a_congruence(
        numbers in elements(STATES * STATES), i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let before = dense(&packed);
        packed.scale(state(i), factor);
        let mut f = Dense::identity();
        f[(i, i)] = factor;
        prop_assert!(close(&dense(&packed), &(f * before * f.transpose())));
    }

    #[test]
    fn a_reduction_is_josephs_form_at_its_gain(
        numbers in elements(STATES * STATES), seen in 0..STATES, noise in 0.01..5.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let before = dense(&packed);
        let mut h = SVector::<f64, STATES>::zeros().transpose();
        h[seen] = 1.0;
        let k = before * h.transpose() / ((h * before * h.transpose())[0] + noise);
        let keep = Dense::identity() - k * h;
        let expected = keep * before * keep.transpose() + k * noise * k.transpose();

        let cross = packed.row(state(seen));
        let variance = cross[seen] + noise;
        let gain = cross.map(|element| element / variance);
        packed.reduce(&gain, &cross);
        prop_assert!(close(&dense(&packed), &expected));
    }

    #[test]
    fn a_subtracted_cross_is_that_of_dense_matrices(
        numbers in elements(STATES * STATES),
        b in elements(STATES), i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let before = dense(&packed);
        packed.subtract_cross(state(i), factor, &vector(&b));
        let mut h = SVector::<f64, STATES>::zeros();
        h[i] = factor;
        let b = SVector::<f64, STATES>::from_column_slice(&b);
        let expected = before - h * b.transpose() - b * h.transpose();
        prop_assert!(close(&dense(&packed), &expected));
    }

    #[test]
    fn a_product_is_that_of_the_dense_matrix(
        numbers in elements(STATES * STATES), factors in elements(STATES),
    ) {
        let packed = positive(&numbers);
        let product = SVector::from(packed.times(&vector(&factors)));
        let expected = dense(&packed) * SVector::<f64, STATES>::from_column_slice(&factors);
        prop_assert!((product - expected).amax() <= 1e-9 * (1.0 + expected.amax()));
    }
}

#[test]
fn a_covariance_is_sound_with_finite_variances_that_are_not_negative() {
    let mut sound = Covariance::<f64>::ZERO;
    for state in StateIndex::ALL {
        sound.add(state, state, 2.0);
    }
    assert!(sound.is_sound());
    for state in StateIndex::ALL {
        for wrong in [-3.0, f64::NAN, f64::INFINITY] {
            let mut unsound = sound;
            unsound.add(state, state, wrong);
            assert!(!unsound.is_sound(), "{state:?} {wrong}");
        }
    }
}
