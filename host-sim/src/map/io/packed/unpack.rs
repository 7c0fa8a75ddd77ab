//! A packed map, read back as rows.

use crate::error::{Error, Result};
use crate::map::fusion::map_row::{MapRow, WayRows};
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::way_name::{self, WayName};
use estimator_core::roadmap::{Block, MapError, MapPoint, PackedMap, WayDirection};
use std::path::Path;

/// Opens a packed map for the rest of the program. Its bytes are never given back.
///
/// # Errors
/// Returns the error of the file system, or says what is wrong with the map.
pub fn open(path: &Path) -> Result<PackedMap<'static>> {
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    PackedMap::open(bytes.leak()).map_err(wrong(path))
}

/// Reads a packed map way by way.
///
/// # Errors
/// Returns the error of the file system, or says what is wrong with the map.
pub fn read(path: &Path) -> Result<Vec<WayRows>> {
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    ways(&bytes).map_err(wrong(path))
}

fn wrong(path: &Path) -> impl Fn(MapError) -> Error {
    move |problem| {
        let expected = "expected a packed map, as `roadgrade pack` writes it";
        Error::content(path, format!("{problem}; {expected}"))
    }
}

fn ways(bytes: &[u8]) -> std::result::Result<Vec<WayRows>, MapError> {
    let map = PackedMap::open(bytes)?;
    map.ways()
        .map(|way| {
            let way = way?;
            let mut rows = Vec::new();
            for block in map.blocks(&way) {
                rows.extend(block_rows(&block?)?);
            }
            let text = way.name()?;
            let named = |direction| {
                Some(WayName {
                    way: text.to_owned(),
                    direction,
                })
            };
            let name = match way.direction {
                WayDirection::Forward => named(way_name::WayDirection::Forward),
                WayDirection::Backward => named(way_name::WayDirection::Backward),
                WayDirection::SingleRoad => None,
            };
            Ok(WayRows { name, rows })
        })
        .collect()
}

/// Returns the cells of a block with their places.
pub(in crate::map::io) fn block_rows(
    block: &Block<'_>,
) -> std::result::Result<Vec<MapRow>, MapError> {
    let points: Vec<MapPoint> = block.points().collect();
    let rows: Vec<MapRow> = block
        .cells()?
        .map(|cell| {
            let (latitude_deg, longitude_deg) = position_deg(&points, cell.cell);
            MapRow {
                distance_m: f64::from(cell.cell) * GRID_M,
                latitude_deg,
                longitude_deg,
                altitude_m: cell.altitude_m.map(f64::from),
                grade_percent: cell.grade_percent.into(),
                grade_sigma_percent: cell.grade_sigma_percent.into(),
                runs: cell.runs,
            }
        })
        .collect();
    if rows.len() == usize::from(block.count) {
        Ok(rows)
    } else {
        Err(MapError::Content)
    }
}

/// Returns the place of a cell on the straight line between the points around it.
fn position_deg(points: &[MapPoint], cell: i32) -> (f64, f64) {
    let after = points
        .partition_point(|point| point.cell < cell)
        .clamp(1, points.len().max(2) - 1);
    let [a, b] = [after - 1, after.min(points.len() - 1)].map(|i| points[i.min(points.len() - 1)]);
    let part = f64::from(cell - a.cell) / f64::from((b.cell - a.cell).max(1));
    let ((south, west), (north, mut east)) = (a.position_deg(), b.position_deg());
    if (east - west).abs() > 180.0 {
        east += 360.0_f64.copysign(west);
    }
    let longitude = west + part * (east - west);
    let turned = if longitude.abs() > 180.0 {
        longitude - 360.0_f64.copysign(longitude)
    } else {
        longitude
    };
    (south + part * (north - south), turned)
}
