//! What an accelerometer leaves for the next drive, and how that drive begins with it.
//!
//! Kept errors serve at once where the force model does not hold. They do not overrule a force before
//! they have agreed with it: the sensor may have been moved ([`Accelerometer::is_untested`]).

use super::super::body_sensor::{BodySensor, OffsetOrigin};
use super::super::noise_ratio::{learned_sigma, variance_ratio};
use super::super::state::State;
use super::super::state_index::StateIndex::Scale;
use super::Accelerometer;
use super::alone::PERCENT_PER_MPS2;
use super::weighing::Weighing;
use crate::scalar::Scalar;
use crate::tuning::{Inertial, Tuning};

impl Accelerometer {
    /// Starts with what an earlier drive left, before the first sample.
    pub(in super::super) fn resume(&mut self, kept: &BodySensor, tuning: &Tuning) {
        let sigma = tuning.inertial.acceleration_sigma_mps2;
        self.noise.set(variance_ratio(kept.noise_sigma, sigma));
        self.errors.resume(kept);
        self.is_trusted = true;
        self.offset_origin = OffsetOrigin::LevelRoad;
    }

    /// Returns what this drive leaves, if it trusts the accelerometer.
    pub(in super::super) fn kept<S: Scalar>(
        &self,
        state: &State<S>,
        tuning: &Tuning,
    ) -> Option<BodySensor> {
        if !self.is_trusted {
            return None;
        }
        let sigma = tuning.inertial.acceleration_sigma_mps2;
        let learned = self.errors.sensor(learned_sigma(self.noise.ratio(), sigma));
        Some(self.offset_origin.kept(learned, model_error_mps2(state)))
    }

    /// Takes the slow error of the model of this drive from kept errors: those that are learned are
    /// relative to it. The sensor is cold, and the scale is what the filter takes it for.
    pub(super) fn relate<S: Scalar>(&mut self, state: &State<S>, tuning: &Inertial) {
        let (error_mps2, variance) = model_error_mps2(state);
        let cold = tuning.kept_offset_sigma_mps2;
        let scale = state.mean[Scale].to_f32();
        let scale_variance = state.covariance.variance(Scale).to_f32();
        self.errors.relate(error_mps2, variance + cold * cold);
        self.errors.set_scale(scale, scale_variance);
        self.weighing = Weighing::knowing(scale, scale_variance);
        self.offset_origin = OffsetOrigin::Model;
    }

    /// Returns whether kept errors have not agreed with the force of this drive for long yet.
    pub(super) fn is_untested(&self, tuning: &Inertial) -> bool {
        self.learned_m < tuning.learned_m
    }
}

/// Returns the slow error of the model as an acceleration, m/s², and its variance, (m/s²)².
fn model_error_mps2<S: Scalar>(state: &State<S>) -> (f32, f32) {
    let (percent, variance) = state.model_error();
    let mps2 = 1.0 / PERCENT_PER_MPS2;
    (mps2 * percent, mps2 * mps2 * variance)
}
