//! MAP.csv, or MAP.parquet: the cells of one road, fused over runs.

use super::{RoadPoint, map_parquet};
use crate::error::Result;
use crate::output::Staged;
use crate::parquet_file::is_parquet;
use crate::row_check::{self, Flaw};
use crate::run_file::{read_checked, round, stage_csv};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One cell of a map. Cells that no run covered have no row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapRow {
    /// Along the road; a multiple of 2.5 m.
    pub distance_m: f64,
    pub latitude_deg: f64,
    pub longitude_deg: f64,
    /// Empty where no run knew it.
    pub altitude_m: Option<f64>,
    /// 100 tan of the slope angle, positive uphill in the road's direction.
    pub grade_percent: f64,
    /// From the runs' own sigmas, what runs of one session share, and what all share.
    pub grade_sigma_percent: f64,
    /// How many traversals went in.
    pub runs: u32,
}

impl MapRow {
    /// Where it lies.
    #[must_use]
    pub const fn point(&self) -> RoadPoint {
        RoadPoint {
            distance_m: self.distance_m,
            latitude_deg: self.latitude_deg,
            longitude_deg: self.longitude_deg,
        }
    }

    /// Whether the row can follow `before` in a map.
    pub(super) fn check(before: Option<&Self>, row: &Self) -> std::result::Result<(), Flaw> {
        row_check::finite(&[
            ("distance_m", row.distance_m),
            ("latitude_deg", row.latitude_deg),
            ("longitude_deg", row.longitude_deg),
            ("altitude_m", row.altitude_m.unwrap_or(0.0)),
            ("grade_percent", row.grade_percent),
            ("grade_sigma_percent", row.grade_sigma_percent),
        ])?;
        row_check::positive(&[("grade_sigma_percent", row.grade_sigma_percent)])?;
        row_check::position(row.latitude_deg, row.longitude_deg)?;
        before.map_or(Ok(()), |before| {
            row_check::forwards("distance_m", before.distance_m, row.distance_m, true)
        })
    }
}

/// Writes a map.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, rows: &[MapRow]) -> Result<()> {
    stage(path, rows)?.commit()
}

/// Writes a map that appears when it is committed: as Parquet if the name ends in .parquet, else
/// as CSV.
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, rows: &[MapRow]) -> Result<Staged> {
    if is_parquet(path) {
        return map_parquet::stage(path, rows);
    }
    stage_csv(
        path,
        rows.iter().map(|row| MapRow {
            distance_m: round(row.distance_m, 2),
            latitude_deg: round(row.latitude_deg, 7),
            longitude_deg: round(row.longitude_deg, 7),
            altitude_m: row.altitude_m.map(|v| round(v, 3)),
            grade_percent: round(row.grade_percent, 5),
            grade_sigma_percent: round(row.grade_sigma_percent, 5),
            runs: row.runs,
        }),
    )
}

/// Reads a map, CSV or Parquet.
///
/// # Errors
/// With file, line and what was expected.
pub fn read(path: &Path) -> Result<Vec<MapRow>> {
    if is_parquet(path) {
        return map_parquet::read(path);
    }
    read_checked(path, MapRow::check)
}
