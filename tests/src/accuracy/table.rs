//! The table of errors: `tests/accuracy.csv`.

use super::errors::Errors;
use super::estimate::Estimate;
use crate::image::root;
use host_sim::error::Result;
use host_sim::files::csv::{read_csv, write_csv};
use host_sim::terminal::table::text_table;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Errors of one drive, or of what stands for several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AccuracyRow {
    /// Its name.
    pub drive: String,
    smoothed_percent: f64,
    lagged_percent: f64,
    live_percent: f64,
    smoothed_nees: f64,
    lagged_nees: f64,
    live_nees: f64,
}

impl AccuracyRow {
    /// Creates a row, rounded as in the file: errors to 0.0001 %, NEES to 0.01.
    #[must_use]
    pub fn new(drive: &str, errors: &Errors) -> Self {
        let [smoothed_percent, lagged_percent, live_percent] =
            errors.rmse_percent.map(|percent| rounded(percent, 1e4));
        let [smoothed_nees, lagged_nees, live_nees] = errors.nees.map(|nees| rounded(nees, 1e2));
        Self {
            drive: drive.to_owned(),
            smoothed_percent,
            lagged_percent,
            live_percent,
            smoothed_nees,
            lagged_nees,
            live_nees,
        }
    }

    /// Returns the root mean square error of an estimate, %.
    #[must_use]
    pub const fn error_percent(&self, estimate: Estimate) -> f64 {
        match estimate {
            Estimate::Smoothed => self.smoothed_percent,
            Estimate::Lagged => self.lagged_percent,
            Estimate::Live => self.live_percent,
        }
    }

    /// Returns the NEES of an estimate.
    #[must_use]
    pub const fn nees(&self, estimate: Estimate) -> f64 {
        match estimate {
            Estimate::Smoothed => self.smoothed_nees,
            Estimate::Lagged => self.lagged_nees,
            Estimate::Live => self.live_nees,
        }
    }

    /// Returns true if both rows are of the same drive.
    #[must_use]
    pub fn is_of_same(&self, other: &Self) -> bool {
        self.drive == other.drive
    }
}

/// Rounds to one part in `parts`.
fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// Returns the path of the committed table.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("tests/accuracy.csv")
}

/// Reads the committed table.
///
/// # Errors
/// Returns an error that names the file and the line.
pub fn committed() -> Result<Vec<AccuracyRow>> {
    read_csv(&committed_file())
}

/// Commits these rows. Rows of `kept` names stay as they are.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(rows: &[AccuracyRow], kept: &[String]) -> Result<()> {
    let mut rows = rows.to_vec();
    if !kept.is_empty() {
        let committed = committed()?.into_iter();
        rows.extend(committed.filter(|row| kept.contains(&row.drive)));
    }
    write_csv(&committed_file(), rows)
}

/// Returns the rows for a terminal, with the change of each error from the committed one.
#[must_use]
pub fn text(rows: &[AccuracyRow], committed: &[AccuracyRow]) -> String {
    let header = ["drive", "smoothed %", "lagged %", "live %", "NEES of each"];
    let lines = rows.iter().map(|row| {
        let before = committed.iter().find(|before| before.is_of_same(row));
        let mut cells = vec![row.drive.clone()];
        cells.extend(Estimate::ALL.map(|estimate| {
            let now = row.error_percent(estimate);
            let change = before.map(|before| 100.0 * (now / before.error_percent(estimate) - 1.0));
            change.map_or(format!("{now:.4}"), |change| {
                format!("{now:.4} ({change:+.1} %)")
            })
        }));
        let nees = Estimate::ALL.map(|estimate| format!("{:.2}", row.nees(estimate)));
        cells.push(nees.join(" / "));
        cells
    });
    text_table(&header, &lines.collect::<Vec<_>>(), 2).to_string()
}
