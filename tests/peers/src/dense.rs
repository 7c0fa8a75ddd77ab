//! Filters of libraries on dense matrices, and one written with nalgebra.

use super::Real;
use super::model::{FilterMeter, LinearModel};
use adskalman::{ObservationModel, StateAndCovariance, TransitionModelLinearNoControl};
use kfilter::kalman::{Kalman, KalmanFilter, KalmanPredict, KalmanUpdate};
use kfilter::measurement::{LinearMeasurement, Measurement};
use multicalc::estimation::{self, KalmanModel};
use multicalc::linear_algebra;
use nalgebra::{Const, Matrix2, SMatrix, SVector, Vector2};

/// Measures an empty step: the cost of the harness itself.
pub fn nothing(meter: &mut impl FilterMeter) {
    meter.measure::<3>(0, |measured| [measured[0], measured[1], 0.0]);
}

fn matrix<const R: usize, const C: usize>(rows: [[Real; C]; R]) -> SMatrix<Real, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

struct Plain<const N: usize> {
    f: SMatrix<Real, N, N>,
    q: SMatrix<Real, N, N>,
    h: SMatrix<Real, 2, N>,
    r: Matrix2<Real>,
    x: SVector<Real, N>,
    p: SMatrix<Real, N, N>,
}

/// Measures the textbook equations on nalgebra's matrices, P ← (I − K H) P.
pub fn plain_nalgebra<const N: usize>(meter: &mut impl FilterMeter) {
    let model = LinearModel::<N>::new();
    let mut filter = Plain {
        f: matrix(model.transition),
        q: matrix(model.step_noise),
        h: matrix(model.measured),
        r: matrix(model.noise),
        x: SVector::zeros(),
        p: matrix(model.covariance),
    };
    meter.measure(size_of_val(&filter), |measured| {
        let Plain { f, q, h, r, x, p } = &mut filter;
        *x = *f * *x;
        *p = *f * *p * f.transpose() + *q;
        let cross = *p * h.transpose();
        if let Some(inverse) = (*h * cross + *r).try_inverse() {
            let gain = cross * inverse;
            *x += gain * (Vector2::from(measured) - *h * *x);
            // With H P, not with its transpose: otherwise P loses its symmetry and then diverges.
            *p -= gain * (*h * *p);
        }
        (*x).into()
    });
}

/// Measures multicalc as it is: Joseph's form.
pub fn multicalc<const N: usize>(meter: &mut impl FilterMeter) {
    let model = LinearModel::<N>::new();
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
    meter.measure::<N>(size_of_val(&filter), |measured| {
        filter.predict();
        let _ = filter.update(linear_algebra::Vector::new(measured));
        let state = filter.state();
        core::array::from_fn(|i| state[i])
    });
}

/// Measures kfilter, with the older nalgebra that it depends on.
pub fn kfilter<const N: usize>(meter: &mut impl FilterMeter) {
    use nalgebra_034::{SMatrix, SVector};
    fn matrix<const R: usize, const C: usize>(rows: [[Real; C]; R]) -> SMatrix<Real, R, C> {
        SMatrix::from_fn(|i, j| rows[i][j])
    }
    let model = LinearModel::<N>::new();
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
    meter.measure(bytes, |measured| {
        let _ = filter.predict();
        measurement.set_measurement(measured.into());
        let _ = filter.update(&measurement);
        (*filter.state()).into()
    });
}

struct Transition<const N: usize> {
    f: SMatrix<Real, N, N>,
    transposed: SMatrix<Real, N, N>,
    q: SMatrix<Real, N, N>,
}

impl<const N: usize> TransitionModelLinearNoControl<Real, Const<N>> for Transition<N> {
    fn F(&self) -> &SMatrix<Real, N, N> {
        &self.f
    }
    fn FT(&self) -> &SMatrix<Real, N, N> {
        &self.transposed
    }
    fn Q(&self) -> &SMatrix<Real, N, N> {
        &self.q
    }
}

struct DenseObservation<const N: usize> {
    h: SMatrix<Real, 2, N>,
    transposed: SMatrix<Real, N, 2>,
    r: Matrix2<Real>,
}

impl<const N: usize> ObservationModel<Real, Const<N>, Const<2>> for DenseObservation<N> {
    fn H(&self) -> &SMatrix<Real, 2, N> {
        &self.h
    }
    fn HT(&self) -> &SMatrix<Real, N, 2> {
        &self.transposed
    }
    fn R(&self) -> &Matrix2<Real> {
        &self.r
    }
}

/// Measures adskalman as it is: Joseph's form.
pub fn adskalman<const N: usize>(meter: &mut impl FilterMeter) {
    let model = LinearModel::<N>::new();
    let (f, h) = (matrix(model.transition), matrix(model.measured));
    let transition = Transition {
        f,
        transposed: f.transpose(),
        q: matrix(model.step_noise),
    };
    let observation = DenseObservation {
        h,
        transposed: h.transpose(),
        r: matrix(model.noise),
    };
    let mut estimate = StateAndCovariance::new(SVector::zeros(), matrix(model.covariance));
    let bytes = size_of_val(&transition) + size_of_val(&observation) + size_of_val(&estimate);
    let filter = adskalman::KalmanFilterNoControl::new(&transition, &observation);
    meter.measure(bytes, |measured| {
        if let Ok(next) = filter.step(&estimate, &Vector2::from(measured)) {
            estimate = next;
        }
        (*estimate.state()).into()
    });
}
