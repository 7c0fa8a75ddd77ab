//! Smoothing of a whole run.
//!
//! The samples that the core saw go through its filter a second time, in double precision and with
//! the sensor noise that was known only at the end of the first; then the recursion of the core's
//! fixed lag goes back over all of it. All records are in memory meanwhile: [`bytes_per_km`].

use estimator_core::filter::{Backward, Filter, Record};
use estimator_core::sampler::Sample;
use estimator_core::{CELL_LENGTH_M, Counters, Estimate, Place, Scalar, Tuning, VehicleParameters};

/// A cell of a smoothed run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Where and when.
    pub place: Place,
    /// What is known there with all of the run.
    pub estimate: Estimate,
}

/// The smoothed run: one cell for each sample from the first speed on. `filter` is the one that the
/// run begins with: that of the first pass [anew](Filter::anew).
#[must_use]
pub fn smooth_run(
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    mut filter: Filter<f64>,
    samples: &[Sample],
) -> Vec<Smoothed> {
    let mut counters = Counters::default();
    let records: Vec<Record<f64>> = samples
        .iter()
        .filter_map(|sample| filter.step(vehicle, tuning, sample, &mut counters))
        .collect();
    records
        .iter()
        .zip(smooth(&records))
        .map(|(record, estimate)| Smoothed {
            place: record.place,
            estimate,
        })
        .collect()
}

/// The smoothed estimate of each record.
#[must_use]
pub fn smooth<S: Scalar>(records: &[Record<S>]) -> Vec<Estimate> {
    let mut backward = Backward::new();
    let mut estimates: Vec<Estimate> = records
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

/// Memory that smoothing needs for each kilometre driven, bytes.
#[must_use]
pub const fn bytes_per_km() -> usize {
    let cell = size_of::<Sample>() + size_of::<Record<f64>>() + size_of::<Estimate>();
    (1_000.0 / CELL_LENGTH_M) as usize * cell
}
