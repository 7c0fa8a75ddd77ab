//! Smoothing of a whole run.
//!
//! The samples that the core saw go through its filter a second time, in double precision and with
//! the sensor noise that was known only at the end of the first; then the recursion of the core's
//! fixed lag goes back over all of it. All records are in memory meanwhile: [`bytes_per_km`].

use estimator_core::filter::{AltitudeEvent, Backward, Filter, Record};
use estimator_core::sampler::{Continuity, Sample};
use estimator_core::{CELL_LENGTH_M, Counters, Estimate, Place, Scalar, Tuning, VehicleParameters};
use std::ops::RangeInclusive;

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
///
/// Where the filter finds that GNSS drifts, it has already followed it for some hundred metres: it
/// then goes over the run twice more, without the fixes since the drift began, and believing all of
/// them: a vehicle far from its parameters looks the same from where it begins. The pass counts that
/// its fixes fit best.
#[must_use]
pub fn smooth_run<S: Scalar>(
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    filter: &Filter<S>,
    samples: &[Sample],
) -> Vec<Smoothed> {
    let pass = |samples: &[Sample], tuning: &Tuning| -> Vec<Record<S>> {
        let mut filter = filter.clone();
        let mut counters = Counters::default();
        samples
            .iter()
            .filter_map(|sample| filter.step(vehicle, tuning, sample, &mut counters))
            .collect()
    };
    let mut records = pass(samples, tuning);
    let drifts = drifts(&records);
    if !drifts.is_empty() {
        let believing = Tuning {
            drift_sigmas: f32::INFINITY,
            ..tuning.clone()
        };
        for other in [
            pass(&without_drifts(samples, &drifts), tuning),
            pass(samples, &believing),
        ] {
            if surprise(&other) < surprise(&records) {
                records = other;
            }
        }
    }
    records
        .iter()
        .zip(smooth(&records))
        .map(|(record, estimate)| Smoothed {
            place: record.place,
            estimate,
        })
        .collect()
}

/// Cells from where GNSS began to drift to where it did no longer, in the order of the run.
fn drifts<S>(records: &[Record<S>]) -> Vec<RangeInclusive<u32>> {
    records
        .iter()
        .filter_map(|record| match record.event {
            Some(AltitudeEvent::DriftEnded(since)) => Some(since..=record.place.cell),
            _ => None,
        })
        .collect()
}

/// Mean of minus twice the logarithm of the likelihood of an altitude, but for a constant.
fn surprise<S: Scalar>(records: &[Record<S>]) -> f64 {
    let altitudes = || records.iter().filter_map(|record| record.trace.altitude);
    let sum: f64 = altitudes()
        .map(|used| {
            let variance = used.innovation_variance.to_f64();
            used.innovation.to_f64().powi(2) / variance + variance.ln()
        })
        .sum();
    sum / altitudes().count() as f64
}

/// The samples without the altitudes of drifts.
fn without_drifts(samples: &[Sample], drifts: &[RangeInclusive<u32>]) -> Vec<Sample> {
    let mut has_drifted = false;
    samples
        .iter()
        .map(|sample| {
            let mut sample = *sample;
            if drifts
                .iter()
                .any(|cells| cells.contains(&sample.place.cell))
            {
                sample.altitude = None;
                has_drifted = true;
            } else if let Some(altitude) = sample.altitude.as_mut().filter(|_| has_drifted) {
                if altitude.continuity == Continuity::Followed {
                    altitude.continuity = Continuity::Drifted;
                }
                has_drifted = false;
            }
            sample
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
