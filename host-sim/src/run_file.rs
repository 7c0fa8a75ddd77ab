//! RUN.csv: one row a cell of one traversal.

use crate::error::{Error, Result};
use crate::output::write_whole;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One cell of a run. Angles in degrees, grades in %, `time_s` from the log's first frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRow {
    pub time_s: f64,
    pub distance_m: f64,
    /// Empty where no fix was near.
    pub latitude_deg: Option<f64>,
    /// Empty where no fix was near.
    pub longitude_deg: Option<f64>,
    /// Empty before the first fix.
    pub altitude_m: Option<f64>,
    pub altitude_sigma_m: Option<f64>,
    /// Smoothed over the whole run.
    pub grade_percent: f64,
    pub grade_sigma_percent: f64,
    /// After a fixed lag.
    pub lagged_grade_percent: f64,
    pub lagged_grade_sigma_percent: f64,
    /// Causal.
    pub live_grade_percent: f64,
    pub live_grade_sigma_percent: f64,
    pub speed_mps: f64,
    /// Grade that the vehicle model reads too high (smoothed).
    pub bias_percent: f64,
    /// True over modelled traction (smoothed).
    pub scale: f64,
    /// 1 where neither a shift nor braking (or their hold times) spoiled the model, else 0.
    pub valid: u8,
}

/// Decimals that a reader can use and a file can bear.
pub(crate) fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10_f64.powi(decimals);
    (value * unit).round() / unit
}

impl RunRow {
    /// With the decimals that the file carries.
    fn rounded(&self) -> Self {
        Self {
            time_s: round(self.time_s, 4),
            distance_m: round(self.distance_m, 2),
            latitude_deg: self.latitude_deg.map(|v| round(v, 7)),
            longitude_deg: self.longitude_deg.map(|v| round(v, 7)),
            altitude_m: self.altitude_m.map(|v| round(v, 3)),
            altitude_sigma_m: self.altitude_sigma_m.map(|v| round(v, 3)),
            grade_percent: round(self.grade_percent, 5),
            grade_sigma_percent: round(self.grade_sigma_percent, 5),
            lagged_grade_percent: round(self.lagged_grade_percent, 5),
            lagged_grade_sigma_percent: round(self.lagged_grade_sigma_percent, 5),
            live_grade_percent: round(self.live_grade_percent, 5),
            live_grade_sigma_percent: round(self.live_grade_sigma_percent, 5),
            speed_mps: round(self.speed_mps, 4),
            bias_percent: round(self.bias_percent, 5),
            scale: round(self.scale, 5),
            valid: self.valid,
        }
    }
}

/// Writes a run.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, rows: &[RunRow]) -> Result<()> {
    write_csv(path, rows.iter().map(RunRow::rounded))
}

/// Reads a run.
///
/// # Errors
/// With file, line and what was expected.
pub fn read(path: &Path) -> Result<Vec<RunRow>> {
    read_csv(path)
}

/// Writes rows as CSV with a header, whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_csv<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<()> {
    write_whole(path, |out| {
        let mut writer = csv::Writer::from_writer(out);
        for row in rows {
            writer.serialize(row).map_err(std::io::Error::other)?;
        }
        writer.flush()
    })
}

/// Reads the rows of a CSV file with a header.
///
/// # Errors
/// With file, line and what was expected; a file without rows is an error too.
pub fn read_csv<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Vec<T>> {
    let file = std::fs::File::open(path).map_err(Error::io(path))?;
    let mut reader = csv::Reader::from_reader(file);
    let mut rows = Vec::new();
    for row in reader.deserialize() {
        rows.push(row.map_err(|e| csv_error(path, &e))?);
    }
    if rows.is_empty() {
        return Err(Error::content(
            path,
            "no rows; expected a header and at least one row",
        ));
    }
    Ok(rows)
}

fn csv_error(path: &Path, error: &csv::Error) -> Error {
    let line = error.position().map_or(1, csv::Position::line);
    let problem = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
        _ => error.to_string(),
    };
    Error::line(
        path,
        line,
        problem,
        "the columns that the README lists, as numbers",
    )
}
