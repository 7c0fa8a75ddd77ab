//! Samples through the filter and the smoother.

use crate::truck;
use estimator_core::filter::{Backward, Filter, Record};
use estimator_core::lag::Lag;
use estimator_core::sampler::Sample;
use estimator_core::{Cell, Counters, Estimate, Scalar, Tuning};
use std::iter::from_fn;

/// The records of a drive of [`truck`].
pub fn run<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> Vec<Record<S>> {
    run_counted(samples, tuning).0
}

/// The same, with what was counted.
pub fn run_counted<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> (Vec<Record<S>>, Counters) {
    let vehicle = truck();
    let mut filter = Filter::new();
    let mut counters = Counters::default();
    let records = samples
        .iter()
        .filter_map(|sample| filter.step(&vehicle, tuning, sample, &mut counters))
        .collect();
    (records, counters)
}

/// Smoothed over all of them.
pub fn smooth<S: Scalar>(records: &[Record<S>]) -> Vec<Estimate> {
    let mut backward = Backward::new();
    let mut estimates: Vec<_> = records
        .iter()
        .rev()
        .map(|record| {
            let estimate = backward.estimate(&record.state);
            backward.retreat(&record.trace);
            estimate
        })
        .collect();
    estimates.reverse();
    estimates
}

/// The cells of a drive, none lost.
pub fn cells<S: Scalar>(records: &[Record<S>]) -> Vec<Cell> {
    let mut lag = Lag::new();
    let mut cells = Vec::new();
    for record in records {
        assert_eq!(lag.push(&record.moved(), &record.state), 0);
        cells.extend(from_fn(|| lag.next_cell()));
    }
    cells.extend(from_fn(|| lag.drain_cell()));
    cells
}
