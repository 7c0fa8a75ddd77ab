//! MAP.parquet: the columns of MAP.csv, numbers in full. And placed runs, from which SQL makes
//! the same map (`host-sim/sql/fuse.sql`).

use super::map_file::MapRow;
use super::placing::PlacedCell;
use super::road_file::RoadRow;
use crate::error::{Error, Result};
use crate::output::Staged;
use crate::parquet_file::{Column, open, stage as stage_parquet};
use std::path::Path;

/// Versions of the columns; in the files' metadata.
const MAP_SCHEMA: &str = "map 1";
const PLACED_SCHEMA: &str = "placed 1";

/// Writes a map that appears when it is committed.
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, rows: &[MapRow]) -> Result<Staged> {
    let numbers = |name, value: fn(&MapRow) -> f64| Column::numbers(name, rows.iter().map(value));
    let columns = vec![
        numbers("distance_m", |row| row.distance_m),
        numbers("latitude_deg", |row| row.latitude_deg),
        numbers("longitude_deg", |row| row.longitude_deg),
        Column::optional("altitude_m", rows.iter().map(|row| row.altitude_m)),
        numbers("grade_percent", |row| row.grade_percent),
        numbers("grade_sigma_percent", |row| row.grade_sigma_percent),
        Column::whole("runs", rows.iter().map(|row| row.runs.into())),
    ];
    stage_parquet(path, columns, &[("schema", MAP_SCHEMA.to_owned())])
}

/// Reads a map.
///
/// # Errors
/// With file, row and what was expected.
pub fn read(path: &Path) -> Result<Vec<MapRow>> {
    let names = [
        "distance_m",
        "latitude_deg",
        "longitude_deg",
        "altitude_m",
        "grade_percent",
        "grade_sigma_percent",
        "runs",
    ];
    let mut rows: Vec<MapRow> = Vec::new();
    open(path)?.read(names, |values| {
        let number = rows.len() as u64 + 1;
        let needed = |i: usize| {
            let problem = || format!("{} is missing", names[i]);
            values[i].ok_or_else(|| Error::line(path, number, problem(), "a number"))
        };
        let row = MapRow {
            distance_m: needed(0)?,
            latitude_deg: needed(1)?,
            longitude_deg: needed(2)?,
            altitude_m: values[3],
            grade_percent: needed(4)?,
            grade_sigma_percent: needed(5)?,
            runs: needed(6)? as u32,
        };
        MapRow::check(rows.last(), &row)
            .map_err(|flaw| Error::line(path, number, flaw.problem, flaw.expected))?;
        rows.push(row);
        Ok(())
    })?;
    Ok(rows)
}

/// Reads a road: any Parquet file with these three columns.
///
/// # Errors
/// With file, row and what was expected.
pub fn read_road(path: &Path) -> Result<Vec<RoadRow>> {
    let names = ["distance_m", "latitude_deg", "longitude_deg"];
    let mut rows: Vec<RoadRow> = Vec::new();
    open(path)?.read(names, |values| {
        let number = rows.len() as u64 + 1;
        let [Some(distance_m), Some(latitude_deg), Some(longitude_deg)] = values else {
            let expected = "distance_m, latitude_deg and longitude_deg";
            return Err(Error::line(path, number, "a number is missing", expected));
        };
        let row = RoadRow {
            distance_m,
            latitude_deg,
            longitude_deg,
            altitude_m: None,
            grade_percent: None,
        };
        RoadRow::check(rows.last(), &row)
            .map_err(|flaw| Error::line(path, number, flaw.problem, flaw.expected))?;
        rows.push(row);
        Ok(())
    })?;
    Ok(rows)
}

/// Writes a run's cells on a road, to appear when committed: `session` (none for a run that
/// belongs to none), `cell` (distance along the road over 2.5 m), grade and altitude with their
/// variances.
///
/// # Errors
/// What the file system says.
pub fn stage_placed(path: &Path, session: Option<&str>, cells: &[PlacedCell]) -> Result<Staged> {
    let altitude = |of: fn((f64, f64)) -> f64| cells.iter().map(move |cell| cell.altitude.map(of));
    let columns = vec![
        Column::text("session", session, cells.len()),
        Column::whole("cell", cells.iter().map(|cell| cell.number)),
        Column::numbers("grade_percent", cells.iter().map(|cell| cell.grade_percent)),
        Column::numbers(
            "grade_variance_percent2",
            cells.iter().map(|cell| cell.grade_variance),
        ),
        Column::optional("altitude_m", altitude(|known| known.0)),
        Column::optional("altitude_variance_m2", altitude(|known| known.1)),
    ];
    stage_parquet(path, columns, &[("schema", PLACED_SCHEMA.to_owned())])
}
