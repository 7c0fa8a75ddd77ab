//! MAP.csv, or MAP.parquet: the cells of one road, or of the ways of a network, fused over runs.

use super::way_file::{self, WayColumns, WayRows};
use super::{RoadPoint, map_parquet};
use crate::error::Result;
use crate::files::csv::stage_csv;
use crate::files::output::Staged;
use crate::files::parquet::is_parquet;
use crate::files::row_check::{self, Flaw};
use crate::numeric::rounding::round;
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

    /// With the decimals that a text file carries.
    fn rounded(&self) -> Self {
        Self {
            distance_m: round(self.distance_m, 2),
            latitude_deg: round(self.latitude_deg, 7),
            longitude_deg: round(self.longitude_deg, 7),
            altitude_m: self.altitude_m.map(|v| round(v, 3)),
            grade_percent: round(self.grade_percent, 5),
            grade_sigma_percent: round(self.grade_sigma_percent, 5),
            runs: self.runs,
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

/// As [`stage`], of a network's map: columns `way` and `direction` come first. Of a single road the
/// file is the same as by [`stage`].
///
/// # Errors
/// What the file system says.
pub fn stage_ways(path: &Path, ways: &[WayRows]) -> Result<Staged> {
    if is_parquet(path) {
        return map_parquet::stage(path, ways);
    }
    if let [WayRows { name: None, rows }] = ways {
        return stage(path, rows);
    }
    stage_csv(
        path,
        ways.iter().flat_map(|way| {
            // Each has a name where there are several.
            let columns = WayColumns::from(way.name.as_ref());
            way.rows
                .iter()
                .map(move |row| (columns.clone(), row.rounded()))
        }),
    )
}

/// Writes a map that appears when it is committed: as Parquet if the name ends in .parquet, else
/// as CSV.
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, rows: &[MapRow]) -> Result<Staged> {
    if is_parquet(path) {
        let way = WayRows {
            name: None,
            rows: rows.to_vec(),
        };
        return map_parquet::stage(path, &[way]);
    }
    stage_csv(path, rows.iter().map(MapRow::rounded))
}

/// Reads a map of a single road, CSV or Parquet.
///
/// # Errors
/// With file, line and what was expected.
pub fn read(path: &Path) -> Result<Vec<MapRow>> {
    way_file::single(path, read_ways(path)?)
}

/// Reads a map way by way, CSV or Parquet.
///
/// # Errors
/// With file, line and what was expected.
pub fn read_ways(path: &Path) -> Result<Vec<WayRows>> {
    if is_parquet(path) {
        return map_parquet::read(path);
    }
    way_file::read_csv(path, MapRow::check)
}
