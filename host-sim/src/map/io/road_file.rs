//! ROAD.csv or ROAD.parquet: a road or several ways from the user; a map is accepted too.

use super::road_row::RoadRow;
use super::{map_parquet, way_file};
use crate::error::Result;
use crate::files::kind::{self, Kind};
use crate::files::limits::ROAD_ROWS;
use crate::files::parquet::is_parquet;
use crate::map::fusion::map_row::WayRows;
use std::path::Path;

/// Reads a single road.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<Vec<RoadRow>> {
    way_file::single(path, read_ways(path)?)
}

/// Reads a road, or ways.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub(crate) fn read_ways(path: &Path) -> Result<Vec<WayRows<RoadRow>>> {
    if is_parquet(path) {
        return map_parquet::read_road(path);
    }
    way_file::read_csv(path, ROAD_ROWS, RoadRow::check)
        .map_err(|e| kind::explained(e, path, &[Kind::Road, Kind::Map, Kind::Run]))
}
