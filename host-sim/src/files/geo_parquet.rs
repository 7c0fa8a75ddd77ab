//! Points in Parquet tables as GeoParquet 1.1 has them (<https://geoparquet.org/releases/v1.1.0/>):
//! a column of well-known binary, and its description in the metadata of the file. The coordinates
//! are longitude and latitude in WGS 84, which GeoParquet assumes.

use super::parquet::ParquetColumn;
use serde_json::json;

/// Name of the column.
const GEOMETRY: &str = "geometry";
/// First bytes of a point as well-known binary (OGC 06-103r4, 8.2): little endian, type 1.
const POINT: [u8; 5] = [1, 1, 0, 0, 0];

/// Returns the column of points (longitude, latitude), °.
pub fn points(positions: impl Iterator<Item = (f64, f64)>) -> ParquetColumn {
    let bytes = |(longitude, latitude): (f64, f64)| {
        let mut point = POINT.to_vec();
        point.extend(longitude.to_le_bytes());
        point.extend(latitude.to_le_bytes());
        point
    };
    ParquetColumn::geometries(GEOMETRY, positions.map(bytes))
}

/// Returns west, south, east and north of positions (longitude, latitude), °; `None` without any.
pub fn extent(positions: impl Iterator<Item = (f64, f64)>) -> Option<[f64; 4]> {
    positions.fold(None, |extent, (longitude, latitude)| {
        let [west, south, east, north] =
            extent.unwrap_or([longitude, latitude, longitude, latitude]);
        Some([
            west.min(longitude),
            south.min(latitude),
            east.max(longitude),
            north.max(latitude),
        ])
    })
}

/// Returns the value of the key `geo` in the metadata of the file.
#[must_use]
pub fn metadata(extent: Option<[f64; 4]>) -> String {
    let mut column = json!({"encoding": "WKB", "geometry_types": ["Point"]});
    if let Some(extent) = extent {
        column["bbox"] = json!(extent);
    }
    json!({
        "version": "1.1.0",
        "primary_column": GEOMETRY,
        "columns": {GEOMETRY: column},
    })
    .to_string()
}
