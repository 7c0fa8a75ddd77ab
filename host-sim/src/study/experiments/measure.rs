//! Errors of a profile as the thesis's tables print them, and maps merged by P.

use super::replica::Replica;
use crate::comparison::Profile;
use std::ops::Range;

/// "All data points except the first and last 200" (section 8.2).
pub const EDGE: usize = 200;

/// Errors of one run, % grade.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunErrors {
    /// Mean where the vehicle model holds.
    pub mu: f64,
    /// Standard deviation there.
    pub sigma: f64,
    /// RMSE there: RMSE(v).
    pub rmse_valid: f64,
    /// RMSE at all points: RMSE(a).
    pub rmse_all: f64,
}

/// Errors of a profile on its run, first and last 200 points left out.
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

/// Error at each point between the ends where the vehicle model holds, %.
#[must_use]
pub fn valid_errors(run: &Replica, grade_percent: &[f64]) -> Vec<f64> {
    (EDGE..run.truth.len() - EDGE)
        .filter(|&k| run.drive.points[k].is_valid())
        .map(|k| grade_percent[k] - run.truth[k])
        .collect()
}

/// RMSE at all points between the ends.
#[must_use]
pub fn rmse(truth: &[f64], grade_percent: &[f64]) -> f64 {
    rms((EDGE..truth.len() - EDGE).map(|k| grade_percent[k] - truth[k]))
}

/// Returns mean over all points between the ends of (error / sigma)²: 1 if the sigmas are honest.
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

/// Runs over the same points merged with 1/P as weights (section 3).
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

/// Returns points between the ends that are left out.
#[must_use]
pub fn inner(run: &Replica) -> Range<usize> {
    EDGE..run.truth.len() - EDGE
}
