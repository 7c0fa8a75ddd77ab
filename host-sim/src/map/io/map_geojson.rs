//! A map as GeoJSON (RFC 7946): lines that a GIS can colour by grade.

use super::way_file::{DIRECTION, WAY};
use crate::error::Result;
use crate::files::output::{Staged, stage as stage_file};
use crate::map::fusion::map_row::{MapRow, WayRows};
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::way_name::WayName;
use crate::numeric::rounding::round;
use geojson::{Feature, FeatureWriter, Geometry, JsonObject, JsonValue, Value as Shape};
use serde_json::json;
use std::io;
use std::path::Path;

/// Writes a map to a file that appears when it is committed. Each segment of a way without a gap is
/// a line with the values of its cells as arrays. With `piece_m`, lines have about that length, m,
/// and the mean grade between their ends.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, ways: &[WayRows], piece_m: Option<f64>) -> Result<Staged> {
    stage_file(path, |out| {
        let mut writer = FeatureWriter::from_writer(out);
        for way in ways {
            for segment in segments(&way.rows) {
                match piece_m {
                    None => write(&mut writer, &whole(way.name.as_ref(), segment))?,
                    Some(piece_m) => {
                        for piece in pieces(segment, piece_m) {
                            write(&mut writer, &feature(way.name.as_ref(), piece))?;
                        }
                    }
                }
            }
        }
        writer.finish().map_err(io::Error::other)
    })
}

fn write<W: io::Write>(writer: &mut FeatureWriter<W>, feature: &Feature) -> io::Result<()> {
    writer.write_feature(feature).map_err(io::Error::other)
}

/// Splits rows at gaps. A line across the date line is split there (RFC 7946, 3.1.9).
pub fn segments(rows: &[MapRow]) -> impl Iterator<Item = &[MapRow]> {
    rows.chunk_by(|a, b| {
        b.distance_m - a.distance_m < 1.5 * GRID_M
            && (b.longitude_deg - a.longitude_deg).abs() < 180.0
    })
}

/// Splits a segment into pieces; each ends where the next begins.
pub(super) fn pieces(segment: &[MapRow], piece_m: f64) -> impl Iterator<Item = &[MapRow]> {
    let cells = ((piece_m / GRID_M).round() as usize).max(1);
    let last = segment.len() - 1;
    (0..last.max(1))
        .step_by(cells)
        .map(move |first| &segment[first..=(first + cells).min(last)])
}

/// Returns a line with its scalar properties.
fn feature(name: Option<&WayName>, rows: &[MapRow]) -> Feature {
    let position = |row: &MapRow| vec![round(row.longitude_deg, 7), round(row.latitude_deg, 7)];
    let geometry = Geometry::new(match rows {
        // A single cell is not a line.
        [only] => Shape::Point(position(only)),
        _ => Shape::LineString(rows.iter().map(position).collect()),
    });
    let (from_m, to_m) = (rows[0].distance_m, rows[rows.len() - 1].distance_m);
    let runs = || rows.iter().map(|row| row.runs);
    let altitudes: Vec<f64> = rows.iter().filter_map(|row| row.altitude_m).collect();
    let altitude_m = altitudes.iter().sum::<f64>() / altitudes.len() as f64;
    let mut properties = JsonObject::new();
    let mut set = |key: &str, value: JsonValue| properties.insert(key.to_owned(), value);
    if let Some(name) = name {
        set(WAY, json!(name.way));
        set(DIRECTION, json!(name.direction));
    }
    set("from_m", json!(round(from_m, 2)));
    set("to_m", json!(round(to_m, 2)));
    set("length_m", json!(round(to_m - from_m, 2)));
    set(
        "grade_percent",
        json!(round(mean(rows, |row| row.grade_percent), 5)),
    );
    // Errors of a run are almost constant over a kilometre, so the sigma of the mean is the mean
    // sigma.
    set(
        "grade_sigma_percent",
        json!(round(mean(rows, |row| row.grade_sigma_percent), 5)),
    );
    // Without a known altitude the mean is NaN, which is null in JSON.
    set("altitude_m", json!(round(altitude_m, 3)));
    set("runs_least", json!(runs().min()));
    set("runs_most", json!(runs().max()));
    Feature {
        geometry: Some(geometry),
        properties: Some(properties),
        ..Feature::default()
    }
}

/// Returns a line with the values of each of its positions.
fn whole(name: Option<&WayName>, rows: &[MapRow]) -> Feature {
    let mut feature = feature(name, rows);
    let numbers = |value: fn(&MapRow) -> f64, decimals: i32| -> JsonValue {
        rows.iter().map(|row| round(value(row), decimals)).collect()
    };
    let altitudes = rows.iter().map(|row| row.altitude_m.map(|v| round(v, 3)));
    feature.set_property("distances_m", numbers(|row| row.distance_m, 2));
    feature.set_property("grades_percent", numbers(|row| row.grade_percent, 5));
    feature.set_property(
        "grade_sigmas_percent",
        numbers(|row| row.grade_sigma_percent, 5),
    );
    feature.set_property("altitudes_m", json!(altitudes.collect::<Vec<_>>()));
    let runs: JsonValue = rows.iter().map(|row| row.runs).collect();
    feature.set_property("runs", runs);
    feature
}

/// Returns the mean along the line through these rows.
pub(super) fn mean(rows: &[MapRow], value: fn(&MapRow) -> f64) -> f64 {
    if let [only] = rows {
        return value(only);
    }
    let between = rows.windows(2);
    let count = between.len() as f64;
    between
        .map(|pair| 0.5 * (value(&pair[0]) + value(&pair[1])))
        .sum::<f64>()
        / count
}
