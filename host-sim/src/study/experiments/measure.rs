//! Errors of a profile as the thesis's tables print them, and maps merged by P.

use super::replica::Replica;
use crate::comparison::Profile;
use std::ops::Range;

/// "All data points except the first and last 200" (section 8.2).
pub const EDGE: usize = 200;

/// Errors of one run, % grade.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunErrors {
    /// Mean where the vehicle model is valid.
    pub mu: f64,
    /// Standard deviation where the vehicle model is valid.
    pub sigma: f64,
    /// RMSE where the vehicle model is valid: RMSE(v).
    pub rmse_valid: f64,
    /// RMSE at all points: RMSE(a).
    pub rmse_all: f64,
}

/// Returns the errors of a profile on its run, without the first and last 200 points.
#[must_use]
pub fn errors(run: &Replica, grade_percent: &[f64]) -> RunErrors {
    let valid = valid_errors(run, grade_percent);
    let count = valid.len() as f64;
    let mu = valid.iter().sum::<f64>() / count;
    let rmse_valid = rms(valid.iter().copied());
    RunErrors {
        mu,
        sigma: (rmse_valid * rmse_valid - mu * mu).sqrt(),
        rmse_valid,
        rmse_all: rmse(&run.truth, grade_percent),
    }
}

/// Returns the error at each point between the ends where the vehicle model is valid, %.
#[must_use]
pub fn valid_errors(run: &Replica, grade_percent: &[f64]) -> Vec<f64> {
    (EDGE..run.truth.len() - EDGE)
        .filter(|&k| run.drive.points[k].is_valid())
        .map(|k| grade_percent[k] - run.truth[k])
        .collect()
}

/// Returns the RMSE at all points between the ends.
#[must_use]
pub fn rmse(truth: &[f64], grade_percent: &[f64]) -> f64 {
    rms((EDGE..truth.len() - EDGE).map(|k| grade_percent[k] - truth[k]))
}

/// Returns the mean of (error / sigma)² over all points between the ends: 1 if the sigmas are
/// consistent.
#[must_use]
pub fn nees(truth: &[f64], profile: &Profile) -> f64 {
    let normalised = |k: usize| {
        let error = profile.grade_percent[k] - truth[k];
        error / profile.sigma_percent[k]
    };
    rms((EDGE..truth.len() - EDGE).map(normalised)).powi(2)
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    f64::sqrt(sum / count)
}

/// Merges runs over the same points with weights 1/P (section 3). Returns the grade, %.
#[must_use]
pub fn merged(profiles: &[&Profile]) -> Vec<f64> {
    let points = profiles
        .first()
        .map_or(0, |profile| profile.grade_percent.len());
    (0..points)
        .map(|k| {
            let (sum, weights) = profiles.iter().fold((0.0, 0.0), |(sum, weights), profile| {
                let weight = profile.sigma_percent[k].powi(-2);
                (sum + weight * profile.grade_percent[k], weights + weight)
            });
            sum / weights
        })
        .collect()
}

/// Returns the points without the first and last 200.
#[must_use]
pub fn inner(run: &Replica) -> Range<usize> {
    EDGE..run.truth.len() - EDGE
}
