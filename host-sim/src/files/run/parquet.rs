//! RUN.parquet: the columns of RUN.csv, with the same decimals.

use super::cell::{Density, RunCell, RunHash, RunIdentity, are_within};
use super::row::{RunRow, RunRows};
use crate::error::{Error, Result};
use crate::files::columns::{self, Column};
use crate::files::limits;
use crate::files::output::Staged;
use crate::files::parquet::{
    NumberColumn, Opened, ParquetColumn, TableWriter, VERTICAL_DATUM, open,
};
use crate::files::row_check::Flaw;
use std::path::Path;

/// Version of the columns, in the metadata of the file.
const SCHEMA: &str = "run 1";
/// Columns that fusion reads.
const CELL_COLUMNS: [&str; 7] = [
    "distance_m",
    "latitude_deg",
    "longitude_deg",
    "altitude_m",
    "altitude_sigma_m",
    "grade_percent",
    "grade_sigma_percent",
];

/// Columns that older files lack.
const NEWER_COLUMNS: [&str; 7] = [
    "mass_kg",
    "mass_sigma_kg",
    CONSISTENT,
    "lagged_consistent",
    "live_consistent",
    "map_grade_percent",
    "map_grade_sigma_percent",
];
const CONSISTENT: &str = "consistent";

/// The origin of a run, as far as it is known. Runs of one vehicle on one day form one session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Name of the vehicle.
    pub vehicle: Option<String>,
    /// Day of the drive, YYYY-MM-DD.
    pub day: Option<String>,
    /// Time of the first input in UTC, as RFC 3339 writes it.
    pub start_utc: Option<String>,
}

impl Origin {
    /// Returns the name of the session; `None` unless vehicle and day are known.
    #[must_use]
    pub fn session(&self) -> Option<String> {
        let (vehicle, day) = (self.vehicle.as_ref()?, self.day.as_ref()?);
        // The name of a session is a line of text wherever it is used.
        let vehicle = vehicle.replace(char::is_control, "_");
        Some(format!("{vehicle} {day}"))
    }
}

/// Number of rows that are encoded at once (20 km).
const BATCH_ROWS: usize = 8192;

/// Writes a run, rounded as in CSV files, to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system or of the rows.
pub fn stage(path: &Path, rows: &mut dyn RunRows, origin: &Origin) -> Result<Staged> {
    let metadata = metadata(rows, origin)?;
    let mut table = TableWriter::begin(path, &columns(&[]), &metadata)?;
    let mut batch = Vec::with_capacity(BATCH_ROWS);
    rows.each(&mut |row| {
        batch.push(*row);
        if batch.len() == BATCH_ROWS {
            table.write(columns(&batch))?;
            batch.clear();
        }
        Ok(())
    })?;
    table.write(columns(&batch))?;
    table.finish()
}

/// Returns a run as a table in memory, rounded as in files.
///
/// # Errors
/// Returns the error of the rows.
#[cfg(feature = "parquet")]
pub fn in_memory(rows: &mut dyn RunRows, origin: &Origin) -> Result<arrow_array::RecordBatch> {
    let mut all = Vec::new();
    rows.each(&mut |row| {
        all.push(*row);
        Ok(())
    })?;
    let metadata = metadata(&mut &*all, origin)?;
    Ok(crate::files::parquet::in_memory(columns(&all), &metadata))
}

/// Returns the metadata of a file with these rows.
fn metadata(rows: &mut dyn RunRows, origin: &Origin) -> Result<Vec<(&'static str, String)>> {
    let mut hash = RunHash::default();
    rows.each(&mut |row| {
        hash.add(&row.into());
        Ok(())
    })?;
    let mut metadata = vec![
        ("schema", SCHEMA.to_owned()),
        ("identity", hash.identity().to_string()),
    ];
    let known = [
        ("vehicle", origin.vehicle.clone()),
        ("day", origin.day.clone()),
        ("session", origin.session()),
        ("start_utc", origin.start_utc.clone()),
        ("vertical_datum", Some(VERTICAL_DATUM.to_owned())),
    ];
    metadata.extend(
        known
            .into_iter()
            .filter_map(|(key, value)| Some((key, value?))),
    );
    Ok(metadata)
}

fn columns(rows: &[RunRow]) -> Vec<ParquetColumn> {
    let numbers =
        |name, value: fn(&RunRow) -> f64| ParquetColumn::numbers(name, rows.iter().map(value));
    let optional = |name, value: fn(&RunRow) -> Option<f64>| {
        ParquetColumn::optional(name, rows.iter().map(value))
    };
    let flags = |name, value: fn(&RunRow) -> u8| {
        ParquetColumn::whole(name, rows.iter().map(|row| value(row).into()))
    };
    vec![
        numbers("time_s", |row| row.time_s),
        numbers("distance_m", |row| row.distance_m),
        optional("latitude_deg", |row| row.latitude_deg),
        optional("longitude_deg", |row| row.longitude_deg),
        optional("altitude_m", |row| row.altitude_m),
        optional("altitude_sigma_m", |row| row.altitude_sigma_m),
        numbers("grade_percent", |row| row.grade_percent),
        numbers("grade_sigma_percent", |row| row.grade_sigma_percent),
        numbers("lagged_grade_percent", |row| row.lagged_grade_percent),
        numbers("lagged_grade_sigma_percent", |row| {
            row.lagged_grade_sigma_percent
        }),
        numbers("live_grade_percent", |row| row.live_grade_percent),
        numbers("live_grade_sigma_percent", |row| {
            row.live_grade_sigma_percent
        }),
        numbers("speed_mps", |row| row.speed_mps),
        numbers("bias_percent", |row| row.bias_percent),
        numbers("scale", |row| row.scale),
        flags("valid", |row| row.valid),
        optional("mass_kg", |row| row.mass_kg),
        optional("mass_sigma_kg", |row| row.mass_sigma_kg),
        flags(CONSISTENT, |row| row.consistent),
        flags("lagged_consistent", |row| row.lagged_consistent),
        flags("live_consistent", |row| row.live_consistent),
        optional("map_grade_percent", |row| row.map_grade_percent),
        optional("map_grade_sigma_percent", |row| row.map_grade_sigma_percent),
    ]
}

/// Opens a run of a known version. A file without a version is accepted if it has the columns.
fn open_run(path: &Path) -> Result<Opened<'_>> {
    let file = open(path)?;
    match file.metadata("schema") {
        None | Some(SCHEMA) => Ok(file),
        Some(other) => Err(Error::content(
            path,
            format!("schema \"{other}\"; expected \"{SCHEMA}\""),
        )),
    }
}

/// Returns the session that the file names, and its number of rows as its footer states it.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub fn outline(path: &Path) -> Result<(Option<String>, usize)> {
    let file = open_run(path)?;
    Ok((file.metadata("session").map(str::to_owned), file.rows()))
}

/// Returns the identity that the file names.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub fn identity(path: &Path) -> Result<Option<RunIdentity>> {
    let file = open_run(path)?;
    Ok(file.metadata("identity").and_then(|text| text.parse().ok()))
}

/// Returns the session that the file names.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub fn session(path: &Path) -> Result<Option<String>> {
    Ok(open_run(path)?.metadata("session").map(str::to_owned))
}

/// Reads a run.
///
/// # Errors
/// Returns an error that names the file, the row and the expected value.
pub fn read(path: &Path) -> Result<Vec<RunRow>> {
    let most = limits::rows_in_memory::<RunRow>();
    let file = open_run(path)?.with_most_rows(most);
    let promised = file.metadata("identity").map(str::to_owned);
    let mut rows: Vec<RunRow> = Vec::new();
    let mut hash = RunHash::default();
    let mut density = Density::default();
    let [
        distance,
        latitude,
        longitude,
        altitude,
        altitude_sigma,
        grade,
        grade_sigma,
    ] = CELL_COLUMNS;
    let names = [
        "time_s",
        distance,
        latitude,
        longitude,
        altitude,
        altitude_sigma,
        grade,
        grade_sigma,
        "lagged_grade_percent",
        "lagged_grade_sigma_percent",
        "live_grade_percent",
        "live_grade_sigma_percent",
        "speed_mps",
        "bias_percent",
        "scale",
        "valid",
    ];
    file.read_newer(names, NEWER_COLUMNS, |values, newer| {
        let number = rows.len() as u64 + 1;
        let needed = |i: usize| values[i].ok_or_else(|| missing(path, number, names[i]));
        let flag = |column: Column, value: Option<f64>| {
            // Nothing is known to disagree in an older file.
            value
                .map_or(Ok(1), |value| column.flag(value))
                .map_err(wrong(path, number))
        };
        let row = RunRow {
            time_s: needed(0)?,
            distance_m: needed(1)?,
            latitude_deg: values[2],
            longitude_deg: values[3],
            altitude_m: values[4],
            altitude_sigma_m: values[5],
            grade_percent: needed(6)?,
            grade_sigma_percent: needed(7)?,
            lagged_grade_percent: needed(8)?,
            lagged_grade_sigma_percent: needed(9)?,
            live_grade_percent: needed(10)?,
            live_grade_sigma_percent: needed(11)?,
            speed_mps: needed(12)?,
            bias_percent: needed(13)?,
            scale: needed(14)?,
            valid: flag(columns::VALID, Some(needed(15)?))?,
            mass_kg: newer[0],
            mass_sigma_kg: newer[1],
            consistent: flag(columns::CONSISTENT, newer[2])?,
            lagged_consistent: flag(columns::LAGGED_CONSISTENT, newer[3])?,
            live_consistent: flag(columns::LIVE_CONSISTENT, newer[4])?,
            map_grade_percent: newer[5],
            map_grade_sigma_percent: newer[6],
        };
        RunRow::check(rows.last(), &row)
            .and_then(|()| density.check(row.distance_m))
            .map_err(wrong(path, number))?;
        hash.add(&RunCell::from(&row));
        limits::push(&mut rows, row, most, path)
    })?;
    check_whole(path, promised.as_deref(), &hash, rows.is_empty())?;
    Ok(rows)
}

/// Passes the columns of a run that fusion needs, at most `most_rows` rows, to `take`.
///
/// # Errors
/// Returns an error that names the file, the row and the expected value.
pub fn each_cell(
    path: &Path,
    most_rows: usize,
    mut take: impl FnMut(RunCell) -> Result<()>,
) -> Result<RunIdentity> {
    let file = open_run(path)?.with_most_rows(most_rows);
    let promised = file.metadata("identity").map(str::to_owned);
    let mut reader = CellReader {
        path,
        number: 0,
        before_m: None,
        density: Density::default(),
        hash: RunHash::default(),
    };
    file.read_batches(CELL_COLUMNS, [CONSISTENT], |rows, columns, [consistent]| {
        if let Some(plain) = plain(columns, rows) {
            // The usual batch: its numbers are checked all at once.
            if are_within(plain) && reader.density.takes_all(plain[0]) {
                return (0..rows).try_for_each(|row| {
                    let values = plain.map(|numbers| numbers[row]);
                    take(reader.checked(values, consistent.at(row))?)
                });
            }
        }
        (0..rows).try_for_each(|row| {
            let values = columns.each_ref().map(|column| column.at(row));
            take(reader.cell(values, consistent.at(row))?)
        })
    })?;
    check_whole(path, promised.as_deref(), &reader.hash, reader.number == 0)
}

/// Returns these columns as doubles if none is missing.
fn plain<'a>(columns: &[NumberColumn<'a>; 7], rows: usize) -> Option<[&'a [f64]; 7]> {
    let mut plain: [&[f64]; 7] = [&[]; 7];
    for (numbers, column) in plain.iter_mut().zip(columns) {
        *numbers = &column.plain()?[..rows];
    }
    Some(plain)
}

/// Checks the cells of a file, one after the other.
struct CellReader<'a> {
    path: &'a Path,
    /// Number of the row.
    number: u64,
    /// Distance of the row before, m.
    before_m: Option<f64>,
    density: Density,
    hash: RunHash,
}

impl CellReader<'_> {
    /// Returns the cell of the next row: its columns in the order of [`CELL_COLUMNS`].
    #[inline]
    fn cell(&mut self, values: [Option<f64>; 7], consistent: Option<f64>) -> Result<RunCell> {
        self.number += 1;
        let (path, number) = (self.path, self.number);
        let needed = |i: usize| values[i].ok_or_else(|| missing(path, number, CELL_COLUMNS[i]));
        let cell = RunCell {
            distance_m: needed(0)?,
            position: values[1].zip(values[2]),
            altitude: values[3].zip(values[4]),
            grade_percent: needed(5)?,
            grade_sigma_percent: needed(6)?,
            is_consistent: self.is_consistent(consistent)?,
        };
        if values[1].is_some() != values[2].is_some() {
            let expected = "both latitude_deg and longitude_deg, or neither";
            return Err(Error::line(path, number, "incomplete position", expected));
        }
        cell.check(self.before_m)
            .and_then(|()| self.density.check(cell.distance_m))
            .map_err(wrong(path, number))?;
        self.before_m = Some(cell.distance_m);
        self.hash.add(&cell);
        Ok(cell)
    }

    /// Returns the cell of the next row, whose numbers were checked with those of its batch.
    #[inline]
    fn checked(&mut self, values: [f64; 7], consistent: Option<f64>) -> Result<RunCell> {
        self.number += 1;
        let cell = RunCell {
            distance_m: values[0],
            position: Some((values[1], values[2])),
            altitude: Some((values[3], values[4])),
            grade_percent: values[5],
            grade_sigma_percent: values[6],
            is_consistent: self.is_consistent(consistent)?,
        };
        self.before_m = Some(cell.distance_m);
        self.hash.add(&cell);
        Ok(cell)
    }

    /// Returns the flag of a cell; nothing is known to disagree in an older file.
    #[inline]
    fn is_consistent(&self, flag: Option<f64>) -> Result<bool> {
        let flag = flag.map_or(Ok(1), |flag| columns::CONSISTENT.flag(flag));
        Ok(flag.map_err(wrong(self.path, self.number))? == 1)
    }
}

/// Returns the error of a flaw of a row.
fn wrong(path: &Path, row: u64) -> impl FnOnce(Flaw) -> Error + '_ {
    move |flaw| Error::line(path, row, flaw.problem, flaw.expected)
}

fn missing(path: &Path, row: u64, name: &str) -> Error {
    Error::line(path, row, format!("{name} is missing"), "a number")
}

/// Checks the cells against the identity in the metadata. Parquet has no checksum that all tools
/// write and verify.
fn check_whole(
    path: &Path,
    promised: Option<&str>,
    hash: &RunHash,
    is_empty: bool,
) -> Result<RunIdentity> {
    if is_empty {
        return Err(Error::content(path, "no rows; expected at least one"));
    }
    let identity = hash.identity();
    match promised {
        Some(promised) if promised != identity.to_string() => Err(Error::content(
            path,
            "damaged: its cells differ from those that were written; restore the file",
        )),
        _ => Ok(identity),
    }
}
