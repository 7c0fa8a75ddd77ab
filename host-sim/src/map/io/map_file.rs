//! MAP.csv or MAP.parquet: the fused cells of one road, or of the ways of a network.

use super::map_parquet;
use super::packed;
use super::way_file::{self, WayColumns};
use crate::error::Result;
use crate::files::csv::stage_csv;
use crate::files::kind::{self, Kind};
use crate::files::limits::MAP_ROWS;
use crate::files::output::Staged;
use crate::files::parquet::is_parquet;
use crate::map::fusion::map_row::{MapRow, WayRows};
use std::path::Path;

/// Writes a map.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(path: &Path, rows: &[MapRow]) -> Result<()> {
    stage(path, rows)?.commit()
}

/// Writes the map of a network as [`stage`] does, with the columns `way` and `direction` first. A
/// single road has no such columns.
///
/// # Errors
/// Returns the error of the file system.
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
            // Each way has a name if there are several.
            let columns = WayColumns::from(way.name.as_ref());
            way.rows
                .iter()
                .map(move |row| (columns.clone(), row.rounded()))
        }),
    )
}

/// Writes a map to a file that appears when it is committed: Parquet if the name ends in .parquet,
/// else CSV.
///
/// # Errors
/// Returns the error of the file system.
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

/// Reads a map of a single road: CSV, Parquet or packed.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<Vec<MapRow>> {
    way_file::single(path, read_ways(path)?)
}

/// Reads a map way by way: CSV, Parquet or packed.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read_ways(path: &Path) -> Result<Vec<WayRows>> {
    if kind::of(path) == Some(Kind::PackedMap) {
        return packed::read(path);
    }
    if is_parquet(path) {
        return map_parquet::read(path);
    }
    way_file::read_csv(path, MAP_ROWS, MapRow::check)
        .map_err(|e| kind::explained(e, path, &[Kind::Map]))
}
