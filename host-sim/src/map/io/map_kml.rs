//! Maps as KML 2.3 (OGC 12-007r2): lines on the ground that Google Earth and QGIS draw.

use super::map_lines::{Line, lines};
use crate::error::Result;
use crate::files::output::{Staged, stage as stage_file};
use crate::map::fusion::map_row::WayRows;
use crate::map::io::map_geojson::mean;
use kml::types::{Coord, Geometry, KmlDocument, LineString, Placemark};
use kml::{Kml, KmlWriter};
use std::collections::HashMap;
use std::io;
use std::path::Path;

/// Namespace of the format.
const NAMESPACE: &str = "http://www.opengis.net/kml/2.2";

/// Writes a map to a file that appears when it is committed. Each line has its mean grade and sigma
/// as description. `piece_m` is the length of the lines, m; without it, each segment without a gap
/// is one.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, ways: &[WayRows], piece_m: Option<f64>) -> Result<Staged> {
    let elements = lines(ways, piece_m).map(placemark).collect();
    let document = Kml::KmlDocument(KmlDocument {
        attrs: HashMap::from([("xmlns".to_owned(), NAMESPACE.to_owned())]),
        elements: vec![Kml::Document {
            attrs: HashMap::new(),
            elements,
        }],
        ..KmlDocument::default()
    });
    stage_file(path, |out| {
        writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
        let mut writer = KmlWriter::from_writer(out);
        writer.write(&document).map_err(io::Error::other)
    })
}

fn placemark(line: Line<'_>) -> Kml {
    let coords = line.rows.iter().map(|row| Coord {
        x: row.longitude_deg,
        y: row.latitude_deg,
        z: row.altitude_m,
    });
    let description = format!(
        "grade {:+.3} %, sigma {:.3} %, from {:.1} to {:.1} m",
        mean(line.rows, |row| row.grade_percent),
        mean(line.rows, |row| row.grade_sigma_percent),
        line.rows[0].distance_m,
        line.rows[line.rows.len() - 1].distance_m,
    );
    Kml::Placemark(Placemark {
        name: Some(line.name),
        description: Some(description),
        geometry: Some(Geometry::LineString(LineString {
            coords: coords.collect(),
            tessellate: true,
            ..LineString::default()
        })),
        ..Placemark::default()
    })
}
