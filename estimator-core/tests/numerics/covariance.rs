//! The packed symmetric matrix against nalgebra's dense one.

use estimator_core::filter::{Covariance, STATES, StateIndex, StateVector};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;

type Dense = SMatrix<f64, STATES, STATES>;

/// Returns the state with this position.
fn state(position: usize) -> StateIndex {
    StateIndex::ALL[position]
}

/// Returns the vector with these elements.
fn vector(elements: [f64; STATES]) -> StateVector<f64> {
    let mut vector = StateVector::ZERO;
    for (state, element) in StateIndex::ALL.into_iter().zip(elements) {
        vector[state] = element;
    }
    vector
}

/// Returns a positive definite matrix.
fn positive(numbers: &[f64]) -> Covariance<f64> {
    let root = Dense::from_fn(|i, j| numbers[i * STATES + j]);
    let product = root * root.transpose() + Dense::identity() * 1e-3;
    let mut covariance = Covariance::ZERO;
    for i in 0..STATES {
        for j in i..STATES {
            covariance.set(state(i), state(j), product[(i, j)]);
        }
    }
    covariance
}

fn close(a: &Dense, b: &Dense) -> bool {
    (a - b).amax() <= 1e-9 * (1.0 + b.amax())
}

proptest! {
    #[test]
    fn shear_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        i in 0..STATES, step in 1..STATES, factor in -3.0..3.0_f64,
    ) {
        let j = (i + step) % STATES;
        let mut packed = positive(&numbers);
        let dense = packed.to_nalgebra();
        packed.shear(state(i), state(j), factor);
        let mut f = Dense::identity();
        f[(i, j)] = factor;
        prop_assert!(close(&packed.to_nalgebra(), &(f * dense * f.transpose())));
    }

    #[test]
    fn scale_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_nalgebra();
        packed.scale(state(i), factor);
        let mut f = Dense::identity();
        f[(i, i)] = factor;
        prop_assert!(close(&packed.to_nalgebra(), &(f * dense * f.transpose())));
    }

    #[test]
    fn a_reduction_is_josephs_form_at_its_gain(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        seen in 0..STATES, noise in 0.01..5.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_nalgebra();
        let mut h = SVector::<f64, STATES>::zeros().transpose();
        h[seen] = 1.0;
        let k = dense * h.transpose() / ((h * dense * h.transpose())[0] + noise);
        let keep = Dense::identity() - k * h;
        let expected = keep * dense * keep.transpose() + k * noise * k.transpose();

        let cross = packed.row(state(seen));
        let variance = cross[state(seen)] + noise;
        let gain = vector(StateIndex::ALL.map(|i| cross[i] / variance));
        packed.reduce(&gain, &cross);
        prop_assert!(close(&packed.to_nalgebra(), &expected));
    }

    #[test]
    fn a_shear_by_a_row_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        row in prop::array::uniform8(-2.0..2.0_f64),
        i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_nalgebra();
        let mut h = SVector::<f64, STATES>::from(row).transpose();
        h[i] = 0.0;
        let cross = dense * h.transpose();
        let variance = (h * cross)[0];
        packed.shear_by(state(i), factor, &vector(cross.into()), variance);
        let mut f = Dense::identity();
        let row = f.row(i) + factor * h;
        f.set_row(i, &row);
        prop_assert!(close(&packed.to_nalgebra(), &(f * dense * f.transpose())));
    }

    #[test]
    fn a_product_is_that_of_the_dense_matrix(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        factors in prop::array::uniform8(-3.0..3.0_f64),
    ) {
        let packed = positive(&numbers);
        let product = packed.times(&vector(factors));
        let dense = packed.to_nalgebra() * SVector::from(factors);
        prop_assert!((product.to_nalgebra() - dense).amax() <= 1e-9 * (1.0 + dense.amax()));
    }

    #[test]
    fn an_added_congruence_is_that_of_dense_matrices(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        others in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        columns in prop::array::uniform8(prop::array::uniform8(-2.0..2.0_f64)),
    ) {
        let (base, other) = (positive(&numbers), positive(&others));
        let sum = base.plus_congruence(&columns.map(vector), &other).to_nalgebra();
        let a = Dense::from_fn(|i, j| columns[j][i]);
        prop_assert!(close(&sum, &(base.to_nalgebra() + a * other.to_nalgebra() * a.transpose())));
    }
}

#[test]
fn a_covariance_is_sound_with_finite_variances_that_are_not_negative() {
    let mut sound = Covariance::<f64>::ZERO;
    for state in StateIndex::ALL {
        sound.set(state, state, 2.0);
    }
    assert!(sound.is_sound());
    for state in StateIndex::ALL {
        for wrong in [-1.0, f64::NAN, f64::INFINITY] {
            let mut unsound = sound;
            unsound.set(state, state, wrong);
            assert!(!unsound.is_sound(), "{state:?} {wrong}");
        }
    }
}
