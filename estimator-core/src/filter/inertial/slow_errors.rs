//! The slow errors of the accelerometer beside the force model.
//!
//! What the accelerometer reads beyond the model is its own offset less the slow error of the model;
//! its gain on the specific force f, because its scale is off and the body pitches under that force,
//! on a slope as under an acceleration a; what it pitches besides under an acceleration; what a
//! wrong scale makes of the net traction l; and what a wrong drag or a steady wind makes of the air
//! resistance per mass, w: d = c + k f + p a + κ g l + λ w. All are found where the model holds. The offset is that relative to the model, so the slope that is read stays the same where
//! the accelerometer stands in. Gain and scale hardly differ in what they do, so that together they
//! are known much better than each.

use super::super::body_sensor::BodySensor;
use crate::scalar::Scalar;
use crate::tuning::Inertial;
use crate::vehicle::GRAVITY;

/// Number of errors.
const ERRORS: usize = 5;
const OFFSET: usize = 0;
const GAIN: usize = 1;
const PITCH_GAIN: usize = 2;
const SCALE: usize = 3;
const AIR: usize = 4;

/// Forces of the model, per mass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ForcesPerMass {
    /// Traction less resistances, % of the weight.
    pub net_traction_percent: f32,
    /// Air resistance, m/s².
    pub air_mps2: f32,
}

/// What the errors are multiplied with in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Regressors([f32; ERRORS]);

impl Regressors {
    /// Creates those of a cell from the specific force and the change of speed, m/s², and from what
    /// the model knows of the cell.
    pub(super) fn new(felt_mps2: f32, change_mps2: f32, forces: ForcesPerMass) -> Self {
        let traction_mps2 = 0.01 * GRAVITY * forces.net_traction_percent;
        Self([1.0, felt_mps2, change_mps2, traction_mps2, forces.air_mps2])
    }
}

/// Mean and covariance of offset, m/s², gain, pitch gain, scale, and part of the air resistance, 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlowErrors {
    mean: [f32; ERRORS],
    covariance: [[f32; ERRORS]; ERRORS],
}

impl SlowErrors {
    /// Creates errors of which nothing is known but what the tuning says.
    pub(super) fn new(tuning: &Inertial) -> Self {
        let sigmas = [
            tuning.offset_sigma_mps2,
            tuning.gain_sigma,
            tuning.pitch_gain_sigma,
            tuning.scale_sigma,
            tuning.air_sigma,
        ];
        let mut covariance = [[0.0; ERRORS]; ERRORS];
        for (i, sigma) in sigmas.into_iter().enumerate() {
            covariance[i][i] = sigma * sigma;
        }
        Self {
            mean: [0.0, tuning.gain, 0.0, 0.0, 0.0],
            covariance,
        }
    }

    /// Starts with offset and gain that an earlier drive left, both of the sensor itself.
    pub(super) const fn resume(&mut self, kept: &BodySensor) {
        self.set(OFFSET, kept.offset, kept.offset_variance);
        self.set(GAIN, kept.gain, kept.gain_variance);
    }

    /// Returns offset and gain with their variances, as those of a sensor with this noise.
    pub(super) const fn sensor(&self, noise_sigma: f32) -> BodySensor {
        BodySensor {
            offset: self.mean[OFFSET],
            offset_variance: self.covariance[OFFSET][OFFSET],
            gain: self.mean[GAIN],
            gain_variance: self.covariance[GAIN][GAIN],
            noise_sigma,
        }
    }

    /// Makes the offset one beside a model whose slow error is known with a variance.
    pub(super) fn relate(&mut self, error_mps2: f32, variance: f32) {
        self.mean[OFFSET] -= error_mps2;
        self.covariance[OFFSET][OFFSET] += variance;
    }

    /// Sets the scale.
    pub(super) const fn set_scale(&mut self, mean: f32, variance: f32) {
        self.set(SCALE, mean, variance);
    }

    const fn set(&mut self, error: usize, mean: f32, variance: f32) {
        self.mean[error] = mean;
        self.covariance[error][error] = variance;
    }

    /// Returns what the accelerometer is expected to read beyond the model, m/s², and its variance.
    #[inline(never)] // Called from several places: flash is scarce.
    pub(super) fn expected(&self, regressors: Regressors) -> (f32, f32) {
        let cross = self.cross(regressors);
        (
            f32::dot(&self.mean, &regressors.0),
            Scalar::max(0.0, f32::dot(&cross, &regressors.0)),
        )
    }

    /// Returns what the reading gains for a specific force, and for a change of speed, 1.
    pub(super) const fn gains(&self) -> (f32, f32) {
        let [_, gain, pitch_gain, ..] = self.mean;
        (1.0 + gain, 1.0 + gain + pitch_gain)
    }

    /// Returns scale and variance of the scale.
    pub(super) const fn scale(&self) -> (f32, f32) {
        (self.mean[SCALE], self.covariance[SCALE][SCALE])
    }

    /// Returns the sum of scale and gain: what a sensor on the right axis and in the right unit shows
    /// of the scale.
    pub(super) fn total_scale(&self) -> (f32, f32) {
        let covariance = &self.covariance;
        (
            self.mean[SCALE] + self.mean[GAIN],
            covariance[SCALE][SCALE] + 2.0 * covariance[SCALE][GAIN] + covariance[GAIN][GAIN],
        )
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
    /// of the model that go with force, acceleration, traction or air do not average out.
    pub(super) fn walk(&mut self, offset_variance: f32, tuning: &Inertial) {
        self.covariance[OFFSET][OFFSET] += offset_variance;
        for (i, sigma) in [
            (GAIN, tuning.gain_least_sigma),
            (PITCH_GAIN, tuning.pitch_gain_least_sigma),
            (SCALE, tuning.scale_least_sigma),
            (AIR, tuning.air_least_sigma),
        ] {
            let variance = &mut self.covariance[i][i];
            *variance = Scalar::max(*variance, sigma * sigma);
        }
    }

    /// Opens the scale: the load may be another one.
    pub(super) fn open_scale(&mut self, sigma: f32) {
        self.covariance[SCALE][SCALE] += sigma * sigma;
    }

    #[inline(never)] // As above.
    fn cross(&self, regressors: Regressors) -> [f32; ERRORS] {
        self.covariance.map(|row| f32::dot(&row, &regressors.0))
    }
}
