//! The packed symmetric matrix against nalgebra's dense one.

use estimator_core::filter::{Covariance, STATES};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;

type Dense = SMatrix<f64, STATES, STATES>;

fn positive(numbers: &[f64]) -> Covariance<f64> {
    let root = Dense::from_fn(|i, j| numbers[i * STATES + j]);
    let product = root * root.transpose() + Dense::identity() * 1e-3;
    let mut covariance = Covariance::ZERO;
    for i in 0..STATES {
        for j in i..STATES {
            covariance.set(i, j, product[(i, j)]);
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
        let dense = packed.to_matrix();
        packed.shear(i, j, factor);
        let mut f = Dense::identity();
        f[(i, j)] = factor;
        prop_assert!(close(&packed.to_matrix(), &(f * dense * f.transpose())));
    }

    #[test]
    fn scale_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_matrix();
        packed.scale(i, factor);
        let mut f = Dense::identity();
        f[(i, i)] = factor;
        prop_assert!(close(&packed.to_matrix(), &(f * dense * f.transpose())));
    }

    #[test]
    fn a_reduction_is_josephs_form_at_its_gain(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        seen in 0..STATES, noise in 0.01..5.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_matrix();
        let mut h = SVector::<f64, STATES>::zeros().transpose();
        h[seen] = 1.0;
        let k = dense * h.transpose() / ((h * dense * h.transpose())[0] + noise);
        let keep = Dense::identity() - k * h;
        let expected = keep * dense * keep.transpose() + k * noise * k.transpose();

        let cross = packed.row(seen);
        let gain = cross.map(|element| element / (cross[seen] + noise));
        packed.reduce(&gain, &cross);
        prop_assert!(close(&packed.to_matrix(), &expected));
    }

    #[test]
    fn a_shear_by_a_look_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        looks in prop::array::uniform8(-2.0..2.0_f64),
        i in 0..STATES, factor in -3.0..3.0_f64,
    ) {
        let mut packed = positive(&numbers);
        let dense = packed.to_matrix();
        let mut h = SVector::<f64, STATES>::from(looks).transpose();
        h[i] = 0.0;
        let cross = dense * h.transpose();
        let variance = (h * cross)[0];
        packed.shear_by(i, factor, &std::array::from_fn(|k| cross[k]), variance);
        let mut f = Dense::identity();
        let row = f.row(i) + factor * h;
        f.set_row(i, &row);
        prop_assert!(close(&packed.to_matrix(), &(f * dense * f.transpose())));
    }

    #[test]
    fn a_product_is_that_of_the_dense_matrix(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        vector in prop::array::uniform8(-3.0..3.0_f64),
    ) {
        let packed = positive(&numbers);
        let product = packed.times(&vector);
        let dense = packed.to_matrix() * SVector::from(vector);
        prop_assert!((SVector::from(product) - dense).amax() <= 1e-9 * (1.0 + dense.amax()));
    }

    #[test]
    fn what_is_added_is_a_congruence(
        numbers in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        others in prop::collection::vec(-2.0..2.0_f64, STATES * STATES),
        columns in prop::array::uniform8(prop::array::uniform8(-2.0..2.0_f64)),
    ) {
        let (base, other) = (positive(&numbers), positive(&others));
        let sum = base.plus_congruence(&columns, &other).to_matrix();
        let a = Dense::from_fn(|i, j| columns[j][i]);
        prop_assert!(close(&sum, &(base.to_matrix() + a * other.to_matrix() * a.transpose())));
    }
}
