//! Drives of other simulators, whose grade is known: `../shared/judge`, scored as its `judge` does.

use super::errors::{Errors, GradeError};
use super::run::run;
use crate::image::root;
use estimator_core::Tuning;
use flate2::read::GzDecoder;
use host_sim::error::{Error, Result};
use host_sim::files::run::RunRow;
use host_sim::files::truth::TruthRow;
use host_sim::files::vehicle::VehicleFile;
use host_sim::numeric::series::linear;
use host_sim::score::END_CUT_M;
use host_sim::source::read_options::ReadOptions;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Returns the folder of a drive, which may be absent.
#[must_use]
pub fn folder(drive: &str) -> PathBuf {
    root().join("../shared/judge").join(drive)
}

/// Judges a drive cell by cell, without the first and last 500 m.
///
/// # Errors
/// Returns an error if a file of the drive cannot be read.
pub fn judge(drive: &str, tuning: &Tuning) -> Result<Errors> {
    let folder = folder(drive);
    let truth = Truth::read(&folder.join("truth.csv.gz"))?;
    let model = VehicleFile::read(&folder.join("vehicle.toml"))?.model;
    let log = folder.join("drive.log.zst");
    let rows = run(&log, &model, tuning, &ReadOptions::default())?;
    Ok(truth.errors(&rows))
}

/// The true way and grade over time, s.
struct Truth {
    distances_m: Vec<(f64, f64)>,
    grades_percent: Vec<(f64, f64)>,
}

impl Truth {
    fn read(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(Error::io(path))?;
        let rows = csv::Reader::from_reader(GzDecoder::new(file))
            .into_deserialize()
            .collect::<std::result::Result<Vec<TruthRow>, _>>()
            .map_err(|error| Error::content(path, error.to_string()))?;
        let over_time = |of: fn(&TruthRow) -> f64| {
            let pairs = rows.iter().map(|row| (row.time_s, of(row)));
            pairs.collect()
        };
        Ok(Self {
            distances_m: over_time(|row| row.distance_m),
            grades_percent: over_time(|row| row.grade_percent),
        })
    }

    fn errors(&self, rows: &[RunRow]) -> Errors {
        let end_m = self.distances_m.last().map_or(0.0, |last| last.1);
        let counted = END_CUT_M..end_m - END_CUT_M;
        let is_counted = |row: &&RunRow| {
            let place_m = linear(&self.distances_m, row.time_s);
            place_m.is_some_and(|place_m| counted.contains(&place_m))
        };
        Errors::new(|estimate| {
            let rows = rows.iter().filter(is_counted);
            rows.filter_map(|row| {
                let (grade_percent, sigma_percent) = estimate.of(row);
                Some(GradeError {
                    error_percent: grade_percent - linear(&self.grades_percent, row.time_s)?,
                    variance: sigma_percent.powi(2),
                })
            })
            .collect()
        })
    }
}
