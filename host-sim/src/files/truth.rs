//! TRUTH.csv: the true state of a simulated drive.

use super::columns;
use super::csv::{read_checked, write_csv};
use super::kind::{self, Kind};
use super::row_check::{self, Flaw};
use crate::error::Result;
use crate::numeric::rounding::round;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The truth at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TruthRow {
    /// Time since the first frame of the log, s.
    pub time_s: f64,
    /// Driven distance, m.
    pub distance_m: f64,
    /// True grade, %: 100 tan of the slope angle, positive uphill in the direction of travel.
    pub grade_percent: f64,
    /// True altitude, m.
    pub altitude_m: f64,
    /// 1 during a gear shift, else 0.
    pub shifting: u8,
    /// 1 while a brake is used, else 0.
    pub braking: u8,
}

impl TruthRow {
    /// Checks that the row can follow `before` in a drive.
    fn check(before: Option<&Self>, row: &Self) -> std::result::Result<(), Flaw> {
        row_check::within(&[
            (columns::TIME_S, row.time_s),
            (columns::DRIVEN_M, row.distance_m),
            (columns::GRADE_PERCENT, row.grade_percent),
            (columns::ALTITUDE_M, row.altitude_m),
        ])?;
        before.map_or(Ok(()), |before| {
            row_check::forwards("time_s", before.time_s, row.time_s, true)?;
            row_check::forwards("distance_m", before.distance_m, row.distance_m, false)
        })
    }
}

/// Writes the truth of a drive.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(path: &Path, rows: &[TruthRow]) -> Result<()> {
    write_csv(
        path,
        rows.iter().map(|row| TruthRow {
            time_s: round(row.time_s, 4),
            distance_m: round(row.distance_m, 3),
            grade_percent: round(row.grade_percent, 5),
            altitude_m: round(row.altitude_m, 4),
            ..*row
        }),
    )
}

/// Reads the truth of a drive.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<Vec<TruthRow>> {
    read_checked(path, TruthRow::check).map_err(|e| kind::explained(e, path, &[Kind::Truth]))
}
