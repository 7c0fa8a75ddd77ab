//! Proposals of inclines as files that JOSM opens. None is made for an upload.

use super::osm::xml::Attribute;
use super::way_file::WAY;
use crate::error::Result;
use crate::files::output::{Staged, stage as stage_file};
use crate::map::slopes::inclines::Incline;
use crate::numeric::rounding::round;
use geojson::{Feature, FeatureWriter, Geometry, JsonObject, JsonValue, Value as Shape};
use serde_json::json;
use std::io;
use std::path::Path;

/// What a mapper is to know of each proposal.
const NOTE: &str = "proposal of roadgrade: compare with the way, split it and tag it by hand";
/// A distance that is an end of the way, m.
const END_M: f64 = 0.5;

/// Writes proposals to a file that appears when it is committed: JOSM's own format if the name ends
/// in .osm, else GeoJSON.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, inclines: &[Incline<'_>]) -> Result<Staged> {
    let is_osm = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("osm"));
    if is_osm {
        stage_file(path, |out| write_osm(out, inclines))
    } else {
        stage_file(path, |out| write_geojson(out, inclines))
    }
}

fn write_geojson(out: &mut dyn io::Write, inclines: &[Incline<'_>]) -> io::Result<()> {
    let mut writer = FeatureWriter::from_writer(out);
    for incline in inclines {
        let position = |&(latitude_deg, longitude_deg): &(f64, f64)| {
            vec![round(longitude_deg, 7), round(latitude_deg, 7)]
        };
        let line = Shape::LineString(incline.positions.iter().map(position).collect());
        let properties: JsonObject = properties(incline)
            .into_iter()
            .map(|(key, value)| (key.to_owned(), value))
            .collect();
        let feature = Feature {
            geometry: Some(Geometry::new(line)),
            properties: Some(properties),
            ..Feature::default()
        };
        writer.write_feature(&feature).map_err(io::Error::other)?;
    }
    writer.finish().map_err(io::Error::other)
}

/// Writes JOSM's format. `upload="never"` makes JOSM refuse to upload the layer
/// (<https://josm.openstreetmap.de/wiki/Help/Concepts/OsmFileFormat>).
fn write_osm(out: &mut dyn io::Write, inclines: &[Incline<'_>]) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<osm version="0.6" upload="never" generator="roadgrade">"#
    )?;
    // Negative identifiers are of objects that the database lacks.
    let mut id = 0_i64;
    for incline in inclines {
        let first = id - 1;
        for &(latitude_deg, longitude_deg) in &incline.positions {
            id -= 1;
            writeln!(
                out,
                r#"  <node id="{id}" lat="{latitude_deg:.7}" lon="{longitude_deg:.7}"/>"#
            )?;
        }
        let last = id;
        id -= 1;
        writeln!(out, r#"  <way id="{id}">"#)?;
        for node in (last..=first).rev() {
            writeln!(out, r#"    <nd ref="{node}"/>"#)?;
        }
        for (key, value) in properties(incline) {
            let text = match value {
                JsonValue::String(text) => text,
                other => other.to_string(),
            };
            // Only the incline has a key of OpenStreetMap.
            let prefix = if key == "incline" { "" } else { "roadgrade:" };
            writeln!(
                out,
                r#"    <tag k="{prefix}{key}" v="{}"/>"#,
                Attribute(&text)
            )?;
        }
        writeln!(out, "  </way>")?;
    }
    writeln!(out, "</osm>")
}

fn properties(incline: &Incline<'_>) -> Vec<(&'static str, JsonValue)> {
    let range_m = &incline.range_m;
    let splits = [
        (range_m.start > END_M).then_some(range_m.start),
        (range_m.end < incline.way_length_m - END_M).then_some(range_m.end),
    ];
    let splits_m: Vec<f64> = splits
        .into_iter()
        .flatten()
        .map(|at| round(at, 1))
        .collect();
    let mut properties = vec![("incline", json!(format!("{}%", incline.incline_percent)))];
    if let Some(way) = incline.way {
        properties.push((WAY, json!(way)));
    }
    properties.extend([
        ("from_m", json!(round(range_m.start, 1))),
        ("to_m", json!(round(range_m.end, 1))),
        ("split_at_m", json!(splits_m)),
        (
            "steepest_percent",
            json!(round(incline.steepest_percent, 3)),
        ),
        ("mean_percent", json!(round(incline.mean_percent, 3))),
        (
            "grade_sigma_percent",
            json!(round(incline.sigma_percent, 3)),
        ),
        ("runs", json!(incline.runs)),
    ]);
    if let Some(structure) = incline.structure {
        properties.push(("structure", json!(structure.word())));
    }
    properties.push(("note", json!(NOTE)));
    properties
}
