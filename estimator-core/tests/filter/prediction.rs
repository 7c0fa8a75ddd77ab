//! The prediction over one cell.

use estimator_core::filter::predict::Prediction;
use estimator_core::filter::{EffectContribution, StateIndex};
use estimator_core::{Context, Tuning};
use test_kit::{FilterRun, sample, speed, truck};

#[test]
fn that_of_the_first_cell_is_the_one_of_a_filter_that_knows_nothing() {
    let mut first = sample(1, 9_000.0, 20.0);
    first.speed = speed(20.0);
    let mut run = FilterRun::<f64>::new(truck(), Tuning::default());
    let step = run.step(&first).expect("a speed");
    let context = Context::new(truck(), Tuning::default()).expect("a possible vehicle");
    let prediction =
        Prediction::<f64>::of_first_cell(&context, &first, EffectContribution::default());
    assert_eq!(*prediction.dynamics(), step.record.smoother_input.dynamics);
    // It moves a state on: the force is more than the resistances, and what is not known grows.
    let mut state = step.state;
    prediction.apply(&mut state);
    let of = |state: &estimator_core::filter::State<f64>, index| {
        (state.mean[index], state.covariance.variance(index))
    };
    let (before, after) = (
        of(&step.state, StateIndex::KineticEnergy),
        of(&state, StateIndex::KineticEnergy),
    );
    assert!(
        after.0 > before.0 && after.1 > before.1,
        "{before:?} {after:?}"
    );
}
