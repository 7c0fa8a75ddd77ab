//! A measured truck on a closed track: windows of 300 m beside the mean of eleven laps. Its altitude
//! is known once a lap, so in between the forces alone make the grade.

use super::errors::{Errors, GradeError};
use super::run::run;
use super::window_means::WindowMeans;
use crate::image::measured_data;
use estimator_core::Tuning;
use host_sim::error::Result;
use host_sim::files::run::RunRow;
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::read_options::ReadOptions;
use host_sim::study::track::laps::Laps;
use std::path::PathBuf;

const WINDOW_M: f64 = 300.0;
/// Where the estimator has found the vehicle's errors, m.
const FROM_M: f64 = 2_500.0;

/// Returns the folder of the laps, which may be absent.
#[must_use]
pub fn folder() -> PathBuf {
    measured_data().join("peterbilt")
}

/// Judges the laps.
///
/// # Errors
/// Returns an error if a file cannot be read.
pub fn judge(tuning: &Tuning) -> Result<Errors> {
    let folder = folder();
    let laps = Laps::read(&folder)?;
    let model = VehicleFile::read(&folder.join("vehicle.toml"))?.model;
    let table = folder.join("laps_1_to_6.csv.gz");
    let rows = run(&table, &model, tuning, &ReadOptions::default())?;
    Ok(errors(&laps, &rows))
}

fn errors(laps: &Laps, rows: &[RunRow]) -> Errors {
    Errors::new(|estimate| {
        let means = WindowMeans::new(rows.iter().filter_map(|row| {
            let (grade_percent, sigma_percent) = estimate.of(row);
            let error_percent = grade_percent - laps.grade_percent(row.distance_m)?;
            Some((row.distance_m, (error_percent, sigma_percent)))
        }));
        let windows = means.windows(FROM_M, WINDOW_M);
        let errors = windows.filter_map(|(from_m, to_m)| {
            let (error_percent, sigma_percent) = means.mean(from_m, to_m)?;
            Some(GradeError {
                error_percent,
                variance: sigma_percent.powi(2),
            })
        });
        errors.collect()
    })
}
