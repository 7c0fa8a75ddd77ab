//! Smoothing of a whole run from the records that the core left.
//!
//! The same recursion as the core's fixed lag, over every record and in double precision. It
//! needs all records of the run in memory: [`bytes_per_km`].

use estimator_core::filter::{Backward, Record};
use estimator_core::{CELL_LENGTH_M, Estimate, Scalar};

/// The smoothed estimate of each record.
#[must_use]
pub fn smooth<S: Scalar>(records: &[Record<S>]) -> Vec<Estimate> {
    let mut backward = Backward::<f64>::new();
    let mut estimates: Vec<Estimate> = records
        .iter()
        .rev()
        .map(|record| {
            let record = record.cast();
            backward.absorb(&record);
            let estimate = backward.estimate(&record);
            backward.retreat(&record);
            estimate
        })
        .collect();
    estimates.reverse();
    estimates
}

/// Memory that whole-run smoothing needs for each kilometre driven, bytes.
#[must_use]
pub fn bytes_per_km<S: Scalar>() -> usize {
    (1_000.0 / CELL_LENGTH_M) as usize * size_of::<Record<S>>()
}
