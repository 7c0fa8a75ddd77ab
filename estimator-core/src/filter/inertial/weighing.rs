//! The scale that the accelerometer shows, as a measurement of the filter.
//!
//! Where the traction changes, force and accelerometer together weigh the vehicle, on any road and
//! without an altitude. What is shown grows over the drive. The filter is given what is new of it:
//! the difference of the informations since the last time. The gain of the sensor is the same all the
//! time, so that all of it together says no more than that gain is known.

use super::super::measurement::{Observation, ScalarMeasurement};
use super::super::state::State;
use super::super::state_index::StateIndex::Scale;
use crate::scalar::Scalar;
use crate::tuning::Inertial;

/// Factor on the variance of the scale: the errors of the model that remain are coloured.
const COLOUR: f32 = 2.0;
/// Least part of the information that is worth a measurement.
const LEAST_PART: f32 = 0.05;

/// What the filter was told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Weighing {
    /// Information, and information times scale.
    told: f32,
    told_scale: f32,
    /// Distance over which the errors were learned at that time, m.
    at_m: f32,
}

impl Weighing {
    /// Creates the memory of a filter that knows the scale with a mean and a variance.
    pub(super) fn knowing(scale: f32, variance: f32) -> Self {
        let told = information(variance);
        Self {
            told,
            told_scale: told * scale,
            at_m: 0.0,
        }
    }

    /// Returns the next measurement of the scale, which is known with a mean and a variance.
    pub(super) fn next<S: Scalar>(
        &mut self,
        (scale, variance): (f32, f32),
        learned_m: f32,
        state: &State<S>,
        tuning: &Inertial,
    ) -> Option<ScalarMeasurement<S>> {
        if learned_m - self.at_m < tuning.weigh_m {
            return None;
        }
        self.at_m = learned_m;
        let information = information(variance);
        let new = information - self.told;
        if new < LEAST_PART * information {
            return None;
        }
        let shown = (information * scale - self.told_scale) / new;
        self.told = information;
        self.told_scale = information * scale;
        Some(ScalarMeasurement {
            observation: Observation::Scale,
            innovation: S::from_f32(shown) - state.mean[Scale],
            variance: S::from_f32(1.0 / new),
        })
    }
}

/// Returns the information of a scale with this variance.
fn information(variance: f32) -> f32 {
    1.0 / (COLOUR * variance)
}
