//! ROAD.csv: a reference road, read and written.

use super::geodesy::Position;
use super::road::{Node, Road};
use crate::error::{Error, Result};
use crate::files::csv::{read_checked_with, write_csv};
use crate::numeric::rounding::round;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Steepest grade allowed, %.
const STEEPEST_PERCENT: f64 = 35.0;

/// Rows of a road: 1,000 km with one every 2 m.
const MOST_ROWS: usize = 500_000;
/// Largest distance along a road, m; a generated road is no longer.
const LARGEST_DISTANCE_M: f64 = 1e6;

/// One row. Altitude is read from the first row only. From there on it is the integral of the
/// grade, so that the simulated truth is consistent.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct RoadFileRow {
    distance_m: f64,
    latitude_deg: f64,
    longitude_deg: f64,
    altitude_m: f64,
    grade_percent: f64,
}

/// Reads a road.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<Road> {
    let rows: Vec<RoadFileRow> =
        read_checked_with(&csv::ReaderBuilder::new(), path, MOST_ROWS, |_, _| Ok(()))?;
    let mut last_m = f64::NEG_INFINITY;
    for (index, row) in rows.iter().enumerate() {
        // The header is line 1.
        check(row, last_m).map_err(|(problem, expected)| {
            Error::line(path, index as u64 + 2, problem, expected)
        })?;
        last_m = row.distance_m;
    }
    let nodes = rows
        .iter()
        .map(|row| Node {
            distance_m: row.distance_m,
            position: Position {
                latitude_deg: row.latitude_deg,
                longitude_deg: row.longitude_deg,
            },
            grade: 0.01 * row.grade_percent,
        })
        .collect();
    let start_altitude_m = rows.first().map_or(0.0, |row| row.altitude_m);
    Road::new(nodes, start_altitude_m)
        .ok_or_else(|| Error::content(path, "only one row; expected at least two"))
}

/// Returns the problem of a row and what was expected.
fn check(row: &RoadFileRow, last_m: f64) -> std::result::Result<(), (String, String)> {
    let within = |name: &str, value: f64, limit: f64| {
        if value.abs() <= limit {
            Ok(())
        } else {
            Err((format!("{name} = {value}"), format!("-{limit} to {limit}")))
        }
    };
    within("latitude_deg", row.latitude_deg, 89.0)?;
    within("longitude_deg", row.longitude_deg, 180.0)?;
    within("altitude_m", row.altitude_m, 9_000.0)?;
    within("grade_percent", row.grade_percent, STEEPEST_PERCENT)?;
    within("distance_m", row.distance_m, LARGEST_DISTANCE_M)?;
    if row.distance_m > last_m {
        Ok(())
    } else {
        Err((
            format!("distance_m = {}", row.distance_m),
            "more than in the row before".to_owned(),
        ))
    }
}

/// Writes a road, one row per node.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(path: &Path, road: &Road) -> Result<()> {
    write_csv(
        path,
        road.nodes().map(|(node, altitude_m)| RoadFileRow {
            distance_m: round(node.distance_m, 3),
            latitude_deg: round(node.position.latitude_deg, 9),
            longitude_deg: round(node.position.longitude_deg, 9),
            altitude_m: round(altitude_m, 4),
            grade_percent: round(100.0 * node.grade, 6),
        }),
    )
}
