//! The context of an estimate: what the parts of the estimator share.

use crate::counters::Counters;
use crate::model::Model;
use crate::tuning::Tuning;
use crate::vehicle::ParameterError;

/// The vehicle model, the tuning and the counters. The estimator owns one context and passes it
/// down.
#[derive(Clone, Debug)]
pub struct Context {
    // First, since every frame counts: a Cortex-M0 reaches only the start of a struct directly.
    /// Counts of what happened.
    pub counters: Counters,
    /// The model of the vehicle.
    pub model: Model,
    /// Noise levels and thresholds.
    pub tuning: Tuning,
}

impl Context {
    /// Creates the context of a vehicle, with all counters zero.
    ///
    /// # Errors
    /// The first parameter of the model that no vehicle can have.
    pub fn new(model: impl Into<Model>, tuning: Tuning) -> Result<Self, ParameterError> {
        let model = model.into();
        model.check()?;
        Ok(Self::of(model, tuning))
    }

    /// Creates the context of a model that is checked.
    #[inline(always)] // So that it is written where it stays.
    pub(crate) fn of(model: Model, tuning: Tuning) -> Self {
        Self {
            model,
            tuning,
            counters: Counters::default(),
        }
    }
}
