//! The slow errors of the accelerometer beside the force model.
//!
//! What the accelerometer reads beyond the model is its own offset less the slow error of the model,
//! its pitch under acceleration, and what a wrong scale makes of the net traction:
//! d = c + k a + κ g ℓ. All three are found where the model holds. The offset is that relative to
//! the model, so the slope that is read stays the same where the accelerometer stands in.

use crate::scalar::Scalar;
use crate::vehicle::GRAVITY;

/// Number of errors: offset, pitch gain, scale.
const ERRORS: usize = 3;
const OFFSET: usize = 0;
const PITCH_GAIN: usize = 1;
const SCALE: usize = 2;

/// What the errors are multiplied with in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Regressors([f32; ERRORS]);

impl Regressors {
    /// Creates those of a cell from the change of speed, m/s², and the net traction, %.
    pub(super) fn new(change_mps2: f32, net_traction_percent: f32) -> Self {
        Self([1.0, change_mps2, 0.01 * GRAVITY * net_traction_percent])
    }

    /// Returns those of a cell without a change of speed.
    pub(super) const fn steady(self) -> Self {
        let [one, _, traction] = self.0;
        Self([one, 0.0, traction])
    }
}

/// Mean and covariance of offset, m/s², pitch gain, 1, and scale, 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlowErrors {
    mean: [f32; ERRORS],
    covariance: [[f32; ERRORS]; ERRORS],
}

impl SlowErrors {
    /// Creates errors with these means and standard deviations.
    pub(super) fn new(mean: [f32; ERRORS], sigmas: [f32; ERRORS]) -> Self {
        let mut covariance = [[0.0; ERRORS]; ERRORS];
        for (i, sigma) in sigmas.into_iter().enumerate() {
            covariance[i][i] = sigma * sigma;
        }
        Self { mean, covariance }
    }

    /// Returns what the accelerometer is expected to read beyond the model, m/s², and its variance.
    pub(super) fn expected(&self, regressors: Regressors) -> (f32, f32) {
        let cross = self.cross(regressors);
        (
            f32::dot(&self.mean, &regressors.0),
            f32::dot(&cross, &regressors.0),
        )
    }

    /// Returns the pitch gain.
    pub(super) const fn pitch_gain(&self) -> f32 {
        self.mean[PITCH_GAIN]
    }

    /// Returns scale and variance of the scale.
    pub(super) const fn scale(&self) -> (f32, f32) {
        (self.mean[SCALE], self.covariance[SCALE][SCALE])
    }

    /// Updates with an innovation, whose noise has this variance.
    pub(super) fn update(&mut self, regressors: Regressors, innovation: f32, variance: f32) {
        let cross = self.cross(regressors);
        let per_variance = 1.0 / (f32::dot(&cross, &regressors.0) + variance);
        for i in 0..ERRORS {
            let gain = cross[i] * per_variance;
            self.mean[i] += gain * innovation;
            for (k, cross) in cross.iter().enumerate() {
                self.covariance[i][k] -= gain * cross;
            }
        }
    }

    /// Lets the offset walk, and keeps the others from being better known than they can be: errors
    /// of the model that go with acceleration or traction do not average out.
    pub(super) fn walk(&mut self, offset_variance: f32, least: [f32; 2]) {
        self.covariance[OFFSET][OFFSET] += offset_variance;
        for (i, sigma) in [PITCH_GAIN, SCALE].into_iter().zip(least) {
            let variance = &mut self.covariance[i][i];
            *variance = Scalar::max(*variance, sigma * sigma);
        }
    }

    /// Opens the scale: the load may be another one.
    pub(super) fn open_scale(&mut self, sigma: f32) {
        self.covariance[SCALE][SCALE] += sigma * sigma;
    }

    fn cross(&self, regressors: Regressors) -> [f32; ERRORS] {
        self.covariance.map(|row| f32::dot(&row, &regressors.0))
    }
}
