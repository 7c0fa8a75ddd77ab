//! A filter step with the state after it.

use estimator_core::filter::{Filter, ModelMass, State, StepRecord};
use estimator_core::sample::Sample;
use estimator_core::{CellEnd, Context, Scalar};

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

/// A cell of a run whose variances are inferred.
#[derive(Clone, Copy, Debug)]
pub(super) struct WholeCell {
    pub end: CellEnd,
    pub mass: ModelMass,
    /// Whether it belongs to the piece, and not to its overlap.
    pub is_own: bool,
}
