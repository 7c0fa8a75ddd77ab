//! Filters on matrices of a library's own, and the plain one written with nalgebra.

use crate::{Model, report};
use adskalman::{ObservationModel, StateAndCovariance, TransitionModelLinearNoControl};
use kfilter::kalman::{Kalman, KalmanFilter, KalmanPredict, KalmanUpdate};
use kfilter::measurement::{LinearMeasurement, Measurement};
use multicalc::estimation::{self, KalmanModel};
use multicalc::linear_algebra;
use nalgebra::{Const, Matrix2, SMatrix, SVector, Vector2};

/// Nothing: what the harness itself takes.
pub fn nothing() {
    report::<3>(0, |measured| [measured[0], measured[1], 0.0]);
}

fn matrix<const R: usize, const C: usize>(rows: [[f32; C]; R]) -> SMatrix<f32, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

struct Plain<const N: usize> {
    f: SMatrix<f32, N, N>,
    q: SMatrix<f32, N, N>,
    h: SMatrix<f32, 2, N>,
    r: Matrix2<f32>,
    x: SVector<f32, N>,
    p: SMatrix<f32, N, N>,
}

/// The textbook's equations on nalgebra's matrices, P ← (I − K H) P.
pub fn plain_nalgebra<const N: usize>() {
    let model = Model::<N>::new();
    let mut filter = Plain {
        f: matrix(model.transition),
        q: matrix(model.step_noise),
        h: matrix(model.measured),
        r: matrix(model.noise),
        x: SVector::zeros(),
        p: matrix(model.covariance),
    };
    report(size_of_val(&filter), |measured| {
        let Plain { f, q, h, r, x, p } = &mut filter;
        *x = *f * *x;
        *p = *f * *p * f.transpose() + *q;
        let cross = *p * h.transpose();
        if let Some(inverse) = (*h * cross + *r).try_inverse() {
            let gain = cross * inverse;
            *x += gain * (Vector2::from(measured) - *h * *x);
            // By H P, not by its transpose: else P loses its symmetry, and then its bounds.
            *p -= gain * (*h * *p);
        }
        (*x).into()
    });
}

/// multicalc, as it comes: Joseph's form.
pub fn multicalc<const N: usize>() {
    let model = Model::<N>::new();
    let mut filter = estimation::KalmanFilter::new(
        linear_algebra::Vector::new([0.0; N]),
        linear_algebra::Matrix::new(model.covariance),
        KalmanModel {
            state_transition: linear_algebra::Matrix::new(model.transition),
            measurement_model: linear_algebra::Matrix::new(model.measured),
            process_noise: linear_algebra::Matrix::new(model.step_noise),
            measurement_noise: linear_algebra::Matrix::new(model.noise),
        },
    );
    report::<N>(size_of_val(&filter), |measured| {
        filter.predict();
        let _ = filter.update(linear_algebra::Vector::new(measured));
        let state = filter.state();
        core::array::from_fn(|i| state[i])
    });
}

/// kfilter, in the older nalgebra that it speaks.
pub fn kfilter<const N: usize>() {
    use nalgebra_034::{SMatrix, SVector};
    fn matrix<const R: usize, const C: usize>(rows: [[f32; C]; R]) -> SMatrix<f32, R, C> {
        SMatrix::from_fn(|i, j| rows[i][j])
    }
    let model = Model::<N>::new();
    let mut filter = Kalman::new(
        matrix(model.transition),
        matrix(model.step_noise),
        SVector::zeros(),
        matrix(model.covariance),
    );
    let mut measurement = LinearMeasurement::new(
        matrix(model.measured),
        matrix(model.noise),
        SVector::zeros(),
    );
    let bytes = size_of_val(&filter) + size_of_val(&measurement);
    report(bytes, |measured| {
        let _ = filter.predict();
        measurement.set_measurement(measured.into());
        let _ = filter.update(&measurement);
        (*filter.state()).into()
    });
}

struct Transition<const N: usize> {
    f: SMatrix<f32, N, N>,
    transposed: SMatrix<f32, N, N>,
    q: SMatrix<f32, N, N>,
}

impl<const N: usize> TransitionModelLinearNoControl<f32, Const<N>> for Transition<N> {
    fn F(&self) -> &SMatrix<f32, N, N> {
        &self.f
    }
    fn FT(&self) -> &SMatrix<f32, N, N> {
        &self.transposed
    }
    fn Q(&self) -> &SMatrix<f32, N, N> {
        &self.q
    }
}

struct Observation<const N: usize> {
    h: SMatrix<f32, 2, N>,
    transposed: SMatrix<f32, N, 2>,
    r: Matrix2<f32>,
}

impl<const N: usize> ObservationModel<f32, Const<N>, Const<2>> for Observation<N> {
    fn H(&self) -> &SMatrix<f32, 2, N> {
        &self.h
    }
    fn HT(&self) -> &SMatrix<f32, N, 2> {
        &self.transposed
    }
    fn R(&self) -> &Matrix2<f32> {
        &self.r
    }
}

/// adskalman, as it comes: Joseph's form.
pub fn adskalman<const N: usize>() {
    let model = Model::<N>::new();
    let (f, h) = (matrix(model.transition), matrix(model.measured));
    let transition = Transition {
        f,
        transposed: f.transpose(),
        q: matrix(model.step_noise),
    };
    let observation = Observation {
        h,
        transposed: h.transpose(),
        r: matrix(model.noise),
    };
    let mut estimate = StateAndCovariance::new(SVector::zeros(), matrix(model.covariance));
    let bytes = size_of_val(&transition) + size_of_val(&observation) + size_of_val(&estimate);
    let filter = adskalman::KalmanFilterNoControl::new(&transition, &observation);
    report(bytes, |measured| {
        if let Ok(next) = filter.step(&estimate, &Vector2::from(measured)) {
            estimate = next;
        }
        (*estimate.state()).into()
    });
}
