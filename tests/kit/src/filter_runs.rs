//! Samples through the filter and the smoother.

use crate::truck;
use estimator_core::filter::{Filter, ModelMass, SensorNoiseRatios, State, StepRecord};
use estimator_core::sample::Sample;
use estimator_core::smoother::{BackwardPass, FixedLag};
use estimator_core::{Cell, Context, Counters, Estimate, Model, Scalar, Tuning};
use std::iter::from_fn;

/// A filter step with the state after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilteredStep<S> {
    pub record: StepRecord<S>,
    pub state: State<S>,
}

/// A filter with its context.
pub struct FilterRun<S> {
    pub filter: Filter<S>,
    pub context: Context,
}

impl<S: Scalar> FilterRun<S> {
    /// Creates a filter that knows nothing yet.
    pub fn new(model: impl Into<Model>, tuning: Tuning) -> Self {
        Self {
            filter: Filter::new(&tuning, &SensorNoiseRatios::default(), None),
            context: Context::new(model, tuning).expect("a possible vehicle"),
        }
    }

    /// Takes a step.
    pub fn step(&mut self, sample: &Sample) -> Option<FilteredStep<S>> {
        let record = self.filter.step(&mut self.context, sample)?;
        let state = *self.filter.state()?;
        Some(FilteredStep { record, state })
    }
}

/// Returns the steps of a drive of [`truck`].
pub fn run<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> Vec<FilteredStep<S>> {
    run_counted(samples, tuning).0
}

/// Returns the steps and the counters.
pub fn run_counted<S: Scalar>(
    samples: &[Sample],
    tuning: &Tuning,
) -> (Vec<FilteredStep<S>>, Counters) {
    let mut run = FilterRun::new(truck(), tuning.clone());
    let cells = samples
        .iter()
        .filter_map(|sample| run.step(sample))
        .collect();
    (cells, run.context.counters)
}

/// Returns the estimates smoothed over all cells.
pub fn smooth<S: Scalar>(cells: &[FilteredStep<S>]) -> Vec<Estimate> {
    let mut pass = BackwardPass::new();
    let mut estimates: Vec<_> = cells
        .iter()
        .rev()
        .map(|cell| {
            let estimate = pass.estimate(&cell.state, &ModelMass::default());
            pass.retreat(&cell.record.smoother_input);
            estimate
        })
        .collect();
    estimates.reverse();
    estimates
}

/// Returns the lagged cells of a drive. Panics if one is lost.
pub fn cells<S: Scalar>(filtered: &[FilteredStep<S>]) -> Vec<Cell> {
    let mut lag = FixedLag::new();
    let mut cells = Vec::new();
    for cell in filtered {
        assert_eq!(lag.push(&cell.record, &cell.state), 0);
        cells.extend(from_fn(|| lag.next_cell()));
    }
    cells.extend(from_fn(|| lag.drain_cell()));
    cells
}
