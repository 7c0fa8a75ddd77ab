//! A filter step with the state after it.

use estimator_core::filter::{Filter, ModelMass, State, StepRecord};
use estimator_core::sample::Sample;
use estimator_core::{Context, Scalar};

/// A filter step with the state after it: the inputs of the backward pass for a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForwardCell<S> {
    /// The step.
    pub record: StepRecord<S>,
    /// Mean and covariance at the cell's end, measurements included.
    pub state: State<S>,
    /// The mass of the model.
    pub mass: ModelMass,
}

impl<S: Scalar> ForwardCell<S> {
    /// Advances a filter by the cell of a sample. Returns `None` while the filter has no estimate.
    pub fn step(filter: &mut Filter<S>, context: &mut Context, sample: &Sample) -> Option<Self> {
        let record = filter.step(context, sample)?;
        let state = *filter.state()?;
        let mass = ModelMass::of(context, sample);
        Some(Self {
            record,
            state,
            mass,
        })
    }
}
