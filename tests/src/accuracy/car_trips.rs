//! A measured car, judged by its accelerometer, which the estimator does not see: windows of 300 m,
//! without the constant offset of the sensor (docs/theory/inertial-judge.md).

use super::errors::{Errors, GradeError};
use super::estimate::Estimate;
use super::run::run;
use super::window_means::WindowMeans;
use crate::image::measured_data;
use estimator_core::{Signal, Tuning};
use host_sim::error::{Error, Result};
use host_sim::files::run::RunRow;
use host_sim::inertial_judge::{InertialProfile, Window, windows_of};
use host_sim::numeric::statistics::{mean, median, quantile};
use host_sim::score::END_CUT_M;
use host_sim::source::i3::{Trip, TripRow, vehicle};
use host_sim::source::read_options::ReadOptions;
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

const WINDOW_M: f64 = 300.0;

/// Returns the file of a trip, which may be absent.
#[must_use]
pub fn file(trip: &str) -> PathBuf {
    folder().join(format!("{trip}.csv.gz"))
}

/// Returns the folder of the trips, which may be absent.
#[must_use]
pub fn folder() -> PathBuf {
    measured_data().join("i3")
}

/// Judges a trip.
///
/// # Errors
/// Returns an error if the trip cannot be read, or its accelerometer judges no window.
pub fn judge(path: &Path, tuning: &Tuning) -> Result<Errors> {
    let judged = judge_if_possible(path, tuning)?;
    judged.ok_or_else(|| Error::content(path, "no window with an accelerometer; expected some"))
}

/// Judges all trips. Returns the median of each figure over the trips, and the value below which nine
/// trips in ten lie.
///
/// # Errors
/// Returns an error if a trip cannot be read.
pub fn judge_all(tuning: &Tuning) -> Result<[Errors; 2]> {
    let folder = folder();
    let entries = fs::read_dir(&folder).map_err(Error::io(&folder))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "gz"))
        .collect();
    files.sort();
    let trips: Vec<_> = files
        .par_iter()
        .filter_map(|path| judge_if_possible(path, tuning).transpose())
        .collect::<Result<_>>()?;
    let nine_in_ten = |values: &[f64]| quantile(values.iter().copied(), 0.9);
    Ok([summary(&trips, median), summary(&trips, nine_in_ten)])
}

/// Sums up each figure over the trips.
fn summary(trips: &[Errors], of: fn(&[f64]) -> f64) -> Errors {
    let figure =
        |figure: &dyn Fn(&Errors) -> f64| of(&trips.iter().map(figure).collect::<Vec<_>>());
    Errors {
        rmse_percent: std::array::from_fn(|k| figure(&|errors| errors.rmse_percent[k])),
        nees: std::array::from_fn(|k| figure(&|errors| errors.nees[k])),
    }
}

/// Judges a trip; `None` if its accelerometer judges no window.
fn judge_if_possible(path: &Path, tuning: &Tuning) -> Result<Option<Errors>> {
    let trip = Trip::read(path)?;
    let windows = windows(trip.rows());
    if windows.is_empty() {
        return Ok(None);
    }
    let scratch = tempfile::tempdir().map_err(Error::io(path))?;
    let table = scratch.path().join("trip.csv");
    trip.write(&table)?;
    let options = ReadOptions {
        ignore: vec![Signal::LongitudinalAcceleration],
        ..ReadOptions::default()
    };
    let rows = run(&table, &vehicle().model, tuning, &options)?;
    Ok(Some(errors(&windows, &rows)))
}

/// Returns the judge's windows, without the first and last 500 m.
fn windows(rows: &[TripRow]) -> Vec<Window> {
    let column = |of: fn(&TripRow) -> Option<f64>| -> Vec<f64> {
        rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect()
    };
    let profile = InertialProfile::new(
        &column(|row| Some(row.time_s)),
        &column(|row| row.speed_mps),
        &column(|row| row.acceleration_mps2),
    );
    let end_m = profile.points().last().map_or(0.0, |last| last.distance_m);
    let mut windows = windows_of(&profile, WINDOW_M);
    windows.retain(|of| of.from_m >= END_CUT_M && of.to_m <= end_m - END_CUT_M);
    windows
}

fn errors(windows: &[Window], rows: &[RunRow]) -> Errors {
    Errors::new(|estimate| without_offset(differences(windows, rows, estimate)))
}

fn differences(windows: &[Window], rows: &[RunRow], estimate: Estimate) -> Vec<GradeError> {
    let means = WindowMeans::new(rows.iter().map(|row| (row.time_s, estimate.of(row))));
    let difference = |window: &Window| {
        let (grade_percent, sigma_percent) = means.mean(window.from_s, window.to_s)?;
        Some(GradeError {
            error_percent: grade_percent - window.grade_percent,
            variance: sigma_percent.powi(2) + window.sigma_percent.powi(2),
        })
    };
    windows.iter().filter_map(difference).collect()
}

/// Removes the mean: the offset of the accelerometer is in it.
fn without_offset(mut errors: Vec<GradeError>) -> Vec<GradeError> {
    let offset_percent = mean(&errors.iter().map(|of| of.error_percent).collect::<Vec<_>>());
    for error in &mut errors {
        error.error_percent -= offset_percent;
    }
    errors
}
