//! The whole estimator on arbitrary traffic: its estimates are finite, and its covariance is
//! assert_positive semidefinite.

use super::from_bytes;
use crate::bus::{Event, EventBus};
use crate::truck;
use estimator_core::estimator::CellEstimator;
use estimator_core::filter::{STATES, State, StateIndex};
use estimator_core::{
    Cell, Context, Estimator, FixedPoint, Intake, Sampler, Scalar, Tuning, Uncertain,
};
use nalgebra::{SMatrix, SymmetricEigen};

/// Least eigenvalue of a correlation matrix that is accepted as rounding.
const ROUNDING: f64 = -1e-6;
/// Steps from one check of the covariance to the next.
const STEPS_PER_CHECK: u32 = 16;

/// Checks the events that the bytes make.
pub fn estimator(bytes: &[u8]) {
    let Some(events) = from_bytes::<Vec<Event>>(bytes) else {
        return;
    };
    check_estimator::<f32>(&events);
    check_estimator::<FixedPoint>(&events);
    check_filter(&events);
}

fn check_estimator<S: Scalar>(events: &[Event]) {
    let mut estimator = Box::new(Estimator::<S>::new(truck(), Tuning::default()).expect("a truck"));
    let mut bus = EventBus::default();
    for event in events {
        bus.play(event, &mut |timed| {
            estimator.on_frame(timed.time, &timed.frame);
            while estimator.step().is_some() {
                if let Some(live) = estimator.live() {
                    assert_sound(live.estimate.grade_percent);
                    assert_sound(live.estimate.bias_percent);
                    assert_sound(live.estimate.scale);
                    live.estimate.altitude_m.into_iter().for_each(assert_sound);
                }
                while let Some(cell) = estimator.next_cell() {
                    assert_sound_cell(&cell);
                }
            }
        });
    }
    while let Some(cell) = estimator.drain_cell() {
        assert_sound_cell(&cell);
    }
    let counters = estimator.counters();
    // Rounding may lose a variance behind a jump that no vehicle makes.
    assert!(counters.restarts <= 2 + counters.steps / 1_000);
    assert_eq!(counters.cells_unsound, 0);
}

fn assert_sound_cell(cell: &Cell) {
    assert_sound(cell.lagged_grade_percent);
    cell.altitude_m.into_iter().for_each(assert_sound);
}

fn assert_sound(known: Uncertain) {
    assert!(known.value.is_finite(), "{known:?}");
    assert!(known.sigma.is_finite() && known.sigma >= 0.0, "{known:?}");
}

fn check_filter(events: &[Event]) {
    let mut context = Context::new(truck(), Tuning::default()).expect("a truck");
    let mut intake = Intake::new(&context.tuning);
    let mut sampler = Sampler::new();
    let mut estimator = CellEstimator::<f32>::new();
    let mut bus = EventBus::default();
    for event in events {
        bus.play(event, &mut |timed| {
            intake.on_frame(&mut context, timed.time, &timed.frame, &mut sampler);
            while let Some(sample) = sampler.next_sample() {
                estimator.push_and_work(&mut context, &sample);
                if let Some(state) = estimator
                    .window()
                    .newest()
                    .filter(|_| context.counters.steps.is_multiple_of(STEPS_PER_CHECK))
                {
                    assert_positive(state);
                }
            }
        });
    }
    estimator
        .window()
        .newest()
        .into_iter()
        .for_each(assert_positive);
}

/// Checks that the covariance, scaled to unit variances, is assert_positive up to rounding.
fn assert_positive(state: &State<f32>) {
    let element = |i: usize, j: usize| {
        let (i, j) = (StateIndex::ALL[i], StateIndex::ALL[j]);
        f64::from(state.covariance.get(i, j))
    };
    let p = SMatrix::<f64, STATES, STATES>::from_fn(element);
    let sigmas = p.diagonal().map(|variance| {
        assert!(variance >= 0.0 && variance.is_finite());
        variance.max(f64::MIN_POSITIVE).sqrt()
    });
    let correlation = p.component_div(&(sigmas * sigmas.transpose()));
    assert!(correlation.iter().all(|element| element.is_finite()), "{p}");
    let least = SymmetricEigen::new(correlation).eigenvalues.min();
    assert!(least >= ROUNDING, "{least}: {p}");
}
