//! A measured truck on a closed track: windows of 300 m beside the mean of eleven laps. Its altitude
//! is known once a lap, so in between the forces alone make the grade.

use super::errors::{Errors, GradeError};
use super::run::run;
use super::window_means::WindowMeans;
use crate::image::measured_data;
use estimator_core::Tuning;
use host_sim::error::Result;
use host_sim::files::csv::read_csv;
use host_sim::files::run::RunRow;
use host_sim::files::vehicle::VehicleFile;
use host_sim::numeric::series::linear;
use host_sim::source::read_options::ReadOptions;
use serde::Deserialize;
use std::path::{Path, PathBuf};

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
    let track = Track::read(&folder)?;
    let model = VehicleFile::read(&folder.join("vehicle.toml"))?.model;
    let table = folder.join("laps_1_to_6.csv.gz");
    let rows = run(&table, &model, tuning, &ReadOptions::default())?;
    Ok(track.errors(&rows))
}

#[derive(Deserialize)]
struct LapStart {
    distance_m: f64,
}

#[derive(Deserialize)]
struct TrueGrade {
    place_m: f64,
    grade_percent: f64,
}

struct Track {
    /// Driven distances at which laps begin, m.
    laps_m: Vec<f64>,
    /// Grade, %, over the place on the lap, m.
    grades: Vec<(f64, f64)>,
}

impl Track {
    fn read(folder: &Path) -> Result<Self> {
        let laps: Vec<LapStart> = read_csv(&folder.join("lap_starts.csv"))?;
        let grades: Vec<TrueGrade> = read_csv(&folder.join("truth.csv"))?;
        Ok(Self {
            laps_m: laps.iter().map(|lap| lap.distance_m).collect(),
            grades: grades
                .iter()
                .map(|of| (of.place_m, of.grade_percent))
                .collect(),
        })
    }

    /// Returns the grade, %, at a driven distance; `None` beyond the laps.
    fn grade_percent(&self, driven_m: f64) -> Option<f64> {
        let begun = self.laps_m.partition_point(|start_m| *start_m <= driven_m);
        let place_m = driven_m - self.laps_m.get(begun.checked_sub(1)?)?;
        // A lap is a few metres longer than the table.
        let last_m = self.grades.last()?.0;
        linear(&self.grades, place_m.min(last_m)).filter(|_| begun < self.laps_m.len())
    }

    fn errors(&self, rows: &[RunRow]) -> Errors {
        Errors::new(|estimate| {
            let means = WindowMeans::new(rows.iter().filter_map(|row| {
                let (grade_percent, sigma_percent) = estimate.of(row);
                let error_percent = grade_percent - self.grade_percent(row.distance_m)?;
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
}
