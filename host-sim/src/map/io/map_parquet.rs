//! MAP.parquet: the columns of MAP.csv, not rounded.

use super::road_row::RoadRow;
use super::way_file::{self, DIRECTION, Grouping, WAY};
use crate::error::{Error, Result};
use crate::files::geo_parquet;
use crate::files::limits::{MAP_ROWS, ROAD_ROWS};
use crate::files::output::Staged;
use crate::files::parquet::{GEO, ParquetColumn, VERTICAL_DATUM, open, stage as stage_parquet};
use crate::files::row_check::Flaw;
use crate::map::fusion::map_row::{MapRow, WayRows};
use crate::map::geometry::way_name::WayName;
use std::path::Path;

/// Version of the columns, in the metadata of the files.
const MAP_SCHEMA: &str = "map 1";

/// Writes a map to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, ways: &[WayRows]) -> Result<Staged> {
    stage_parquet(path, columns(ways), &metadata(ways))
}

/// Returns a map as a table in memory.
#[cfg(feature = "parquet")]
#[must_use]
pub fn table(ways: &[WayRows]) -> arrow_array::RecordBatch {
    crate::files::parquet::in_memory(columns(ways), &metadata(ways))
}

fn columns(ways: &[WayRows]) -> Vec<ParquetColumn> {
    let rows = || ways.iter().flat_map(|way| &way.rows);
    let numbers = |name, value: fn(&MapRow) -> f64| ParquetColumn::numbers(name, rows().map(value));
    let mut columns = Vec::new();
    if ways.iter().any(|way| way.name.is_some()) {
        let texts = |value: fn(&WayName) -> &str| {
            ways.iter().flat_map(move |way| {
                std::iter::repeat_n(way.name.as_ref().map(value), way.rows.len())
            })
        };
        columns.push(ParquetColumn::texts(WAY, texts(|name| &name.way)));
        columns.push(ParquetColumn::texts(
            DIRECTION,
            texts(|name| name.direction.word()),
        ));
    }
    columns.extend([
        numbers("distance_m", |row| row.distance_m),
        numbers("latitude_deg", |row| row.latitude_deg),
        numbers("longitude_deg", |row| row.longitude_deg),
        ParquetColumn::optional("altitude_m", rows().map(|row| row.altitude_m)),
        numbers("grade_percent", |row| row.grade_percent),
        numbers("grade_sigma_percent", |row| row.grade_sigma_percent),
        ParquetColumn::whole("runs", rows().map(|row| row.runs.into())),
        geo_parquet::points(rows().map(|row| (row.longitude_deg, row.latitude_deg))),
    ]);
    columns
}

fn metadata(ways: &[WayRows]) -> [(&'static str, String); 3] {
    let rows = ways.iter().flat_map(|way| &way.rows);
    let extent = geo_parquet::extent(rows.map(|row| (row.longitude_deg, row.latitude_deg)));
    [
        ("schema", MAP_SCHEMA.to_owned()),
        ("vertical_datum", VERTICAL_DATUM.to_owned()),
        (GEO, geo_parquet::metadata(extent)),
    ]
}

/// Reads a map.
///
/// # Errors
/// Returns an error that names the file, the row and the expected value.
pub fn read(path: &Path) -> Result<Vec<WayRows>> {
    let names = [
        "distance_m",
        "latitude_deg",
        "longitude_deg",
        "altitude_m",
        "grade_percent",
        "grade_sigma_percent",
        "runs",
    ];
    let row = |values: [Option<f64>; 7]| {
        let needed = |i: usize| {
            values[i].ok_or_else(|| Flaw {
                problem: format!("{} is missing", names[i]),
                expected: "a number",
            })
        };
        Ok(MapRow {
            distance_m: needed(0)?,
            latitude_deg: needed(1)?,
            longitude_deg: needed(2)?,
            altitude_m: values[3],
            grade_percent: needed(4)?,
            grade_sigma_percent: needed(5)?,
            runs: whole(needed(6)?)?,
        })
    };
    read_ways(path, MAP_ROWS, names, row, MapRow::check)
}

/// Returns a number of runs.
fn whole(runs: f64) -> std::result::Result<u32, Flaw> {
    let is_count = runs.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&runs);
    is_count.then_some(runs as u32).ok_or_else(|| Flaw {
        problem: format!("runs is {runs}"),
        expected: "a whole number from 0",
    })
}

/// Reads a road: any Parquet file with these three columns.
///
/// # Errors
/// Returns an error that names the file, the row and the expected value.
pub fn read_road(path: &Path) -> Result<Vec<WayRows<RoadRow>>> {
    let names = ["distance_m", "latitude_deg", "longitude_deg"];
    let row = |values: [Option<f64>; 3]| match values {
        [Some(distance_m), Some(latitude_deg), Some(longitude_deg)] => Ok(RoadRow {
            distance_m,
            latitude_deg,
            longitude_deg,
            altitude_m: None,
            grade_percent: None,
        }),
        _ => Err(Flaw {
            problem: "a number is missing".to_owned(),
            expected: "distance_m, latitude_deg and longitude_deg",
        }),
    };
    read_ways(path, ROAD_ROWS, names, row, RoadRow::check)
}

fn read_ways<T, const N: usize>(
    path: &Path,
    most: usize,
    names: [&str; N],
    row: impl Fn([Option<f64>; N]) -> std::result::Result<T, Flaw>,
    check: fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<WayRows<T>>> {
    let file = open(path)?.with_most_rows(most);
    let has_ways = file.has_column(WAY);
    let mut grouping = Grouping::new();
    let mut number = 0;
    file.read_texts(names, [WAY, DIRECTION], |values, texts| {
        number += 1;
        let name = has_ways.then(|| way_file::name_of(texts)).transpose();
        name.and_then(|name| grouping.add(name, row(values)?, check))
            .map_err(|flaw| Error::line(path, number, flaw.problem, flaw.expected))
    })?;
    Ok(grouping.done())
}
