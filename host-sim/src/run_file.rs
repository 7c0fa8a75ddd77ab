//! RUN.csv, or RUN.parquet: one row a cell of one traversal.

use crate::error::{Error, Result};
use crate::output::{Staged, Writing, stage};
use crate::parquet_file::is_parquet;
use crate::row_check::{self, Flaw};
use crate::run_cell::{RunCell, RunIdentity};
use crate::run_parquet::{self, Origin};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::Path;

/// One cell of a run. Angles in degrees, grades in %, `time_s` from the log's first frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRow {
    pub time_s: f64,
    pub distance_m: f64,
    /// Empty where no fix was near.
    #[serde(deserialize_with = "column")]
    pub latitude_deg: Option<f64>,
    /// Empty where no fix was near.
    #[serde(deserialize_with = "column")]
    pub longitude_deg: Option<f64>,
    /// Empty before the first fix.
    #[serde(deserialize_with = "column")]
    pub altitude_m: Option<f64>,
    #[serde(deserialize_with = "column")]
    pub altitude_sigma_m: Option<f64>,
    /// Smoothed over the whole run.
    pub grade_percent: f64,
    pub grade_sigma_percent: f64,
    /// After a fixed lag.
    pub lagged_grade_percent: f64,
    pub lagged_grade_sigma_percent: f64,
    /// Causal.
    pub live_grade_percent: f64,
    pub live_grade_sigma_percent: f64,
    pub speed_mps: f64,
    /// Grade that the vehicle model reads too high (smoothed).
    pub bias_percent: f64,
    /// True over modelled traction (smoothed).
    pub scale: f64,
    /// 1 where neither a shift nor braking (or their hold times) spoiled the model, else 0.
    pub valid: u8,
}

/// An optional value of a column that must be there (serde takes a missing column for empty).
pub(crate) fn column<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    cell: D,
) -> std::result::Result<Option<T>, D::Error> {
    Option::deserialize(cell)
}

/// Decimals that a reader can use and a file can bear.
pub(crate) fn round(value: f64, decimals: i32) -> f64 {
    let unit = 10_f64.powi(decimals);
    (value * unit).round() / unit
}

impl RunRow {
    /// Smoothed grade and its standard deviation, %.
    #[must_use]
    pub const fn smoothed(&self) -> (f64, f64) {
        (self.grade_percent, self.grade_sigma_percent)
    }

    /// Lagged grade and its standard deviation, %.
    #[must_use]
    pub const fn lagged(&self) -> (f64, f64) {
        (self.lagged_grade_percent, self.lagged_grade_sigma_percent)
    }

    /// Live grade and its standard deviation, %.
    #[must_use]
    pub const fn live(&self) -> (f64, f64) {
        (self.live_grade_percent, self.live_grade_sigma_percent)
    }

    /// Whether the row can follow `before` in a run.
    pub(crate) fn check(before: Option<&Self>, row: &Self) -> std::result::Result<(), Flaw> {
        row_check::finite(&[
            ("time_s", row.time_s),
            ("distance_m", row.distance_m),
            ("latitude_deg", row.latitude_deg.unwrap_or(0.0)),
            ("longitude_deg", row.longitude_deg.unwrap_or(0.0)),
            ("altitude_m", row.altitude_m.unwrap_or(0.0)),
            ("altitude_sigma_m", row.altitude_sigma_m.unwrap_or(1.0)),
            ("grade_percent", row.grade_percent),
            ("grade_sigma_percent", row.grade_sigma_percent),
            ("lagged_grade_percent", row.lagged_grade_percent),
            ("lagged_grade_sigma_percent", row.lagged_grade_sigma_percent),
            ("live_grade_percent", row.live_grade_percent),
            ("live_grade_sigma_percent", row.live_grade_sigma_percent),
            ("speed_mps", row.speed_mps),
            ("bias_percent", row.bias_percent),
            ("scale", row.scale),
        ])?;
        row_check::positive(&[
            ("altitude_sigma_m", row.altitude_sigma_m.unwrap_or(1.0)),
            ("grade_sigma_percent", row.grade_sigma_percent),
            ("lagged_grade_sigma_percent", row.lagged_grade_sigma_percent),
            ("live_grade_sigma_percent", row.live_grade_sigma_percent),
        ])?;
        match (row.latitude_deg, row.longitude_deg) {
            (Some(latitude_deg), Some(longitude_deg)) => {
                row_check::position(latitude_deg, longitude_deg)?;
            }
            (None, None) => {}
            _ => {
                return Err(Flaw {
                    problem: "half a position".into(),
                    expected: "latitude_deg and longitude_deg, or neither",
                });
            }
        }
        if row.valid > 1 {
            return Err(Flaw {
                problem: format!("valid is {}", row.valid),
                expected: "0 or 1",
            });
        }
        before.map_or(Ok(()), |before| {
            row_check::forwards("time_s", before.time_s, row.time_s, false)?;
            row_check::forwards("distance_m", before.distance_m, row.distance_m, true)
        })
    }

    /// With the decimals that the file carries.
    fn rounded(&self) -> Self {
        Self {
            time_s: round(self.time_s, 4),
            distance_m: round(self.distance_m, 2),
            latitude_deg: self.latitude_deg.map(|v| round(v, 7)),
            longitude_deg: self.longitude_deg.map(|v| round(v, 7)),
            altitude_m: self.altitude_m.map(|v| round(v, 3)),
            altitude_sigma_m: self.altitude_sigma_m.map(|v| round(v, 3)),
            grade_percent: round(self.grade_percent, 5),
            grade_sigma_percent: round(self.grade_sigma_percent, 5),
            lagged_grade_percent: round(self.lagged_grade_percent, 5),
            lagged_grade_sigma_percent: round(self.lagged_grade_sigma_percent, 5),
            live_grade_percent: round(self.live_grade_percent, 5),
            live_grade_sigma_percent: round(self.live_grade_sigma_percent, 5),
            speed_mps: round(self.speed_mps, 4),
            bias_percent: round(self.bias_percent, 5),
            scale: round(self.scale, 5),
            valid: self.valid,
        }
    }
}

/// Writes a run: as Parquet if the name ends in .parquet, else as CSV.
///
/// # Errors
/// What the file system says.
pub fn write(path: &Path, rows: &[RunRow]) -> Result<()> {
    write_from(path, rows, &Origin::default())
}

/// As [`write()`], with what is known of where the run comes from (Parquet only).
///
/// # Errors
/// What the file system says.
pub fn write_from(path: &Path, mut rows: &[RunRow], origin: &Origin) -> Result<()> {
    write_rows(path, &mut rows, origin)
}

/// As [`write_from`], of rows that need not be in memory.
///
/// # Errors
/// What the file system says, or the rows.
pub fn write_rows(path: &Path, rows: &mut dyn RunRows, origin: &Origin) -> Result<()> {
    if is_parquet(path) {
        return run_parquet::stage(path, &mut Rounded(rows), origin)?.commit();
    }
    let mut writing = Writing::begin(path)?;
    let mut writer = csv::Writer::from_writer(&mut writing);
    let failed = |e: csv::Error| Error::io(path)(e.into());
    Rounded(rows).each(&mut |row| writer.serialize(row).map_err(failed))?;
    writer.flush().map_err(Error::io(path))?;
    drop(writer);
    writing.finish()?.commit()
}

/// Rows of a run that can be gone over more than once.
pub trait RunRows {
    /// Passes all of them to `take`, in the order of the run.
    ///
    /// # Errors
    /// Those of `take`; or if they cannot be had.
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()>;
}

impl RunRows for &[RunRow] {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        self.iter().try_for_each(take)
    }
}

/// Rows with the decimals that files carry.
struct Rounded<'a>(&'a mut dyn RunRows);

impl RunRows for Rounded<'_> {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        self.0.each(&mut |row| take(&row.rounded()))
    }
}

/// Reads a run, CSV or Parquet.
///
/// # Errors
/// With file, line and what was expected.
pub fn read(path: &Path) -> Result<Vec<RunRow>> {
    if is_parquet(path) {
        run_parquet::read(path)
    } else {
        read_checked(path, RunRow::check)
    }
}

/// Reads what fusion needs of a run, CSV or Parquet.
///
/// # Errors
/// With file, line and what was expected.
pub fn read_cells(path: &Path) -> Result<(Vec<RunCell>, RunIdentity)> {
    if is_parquet(path) {
        return run_parquet::read_cells(path);
    }
    let cells: Vec<RunCell> = read(path)?.iter().map(RunCell::from).collect();
    let identity = RunIdentity::of(cells.iter().copied());
    Ok((cells, identity))
}

/// Writes rows as CSV with a header, whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_csv<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<()> {
    stage_csv(path, rows)?.commit()
}

/// Writes rows as CSV with a header, to appear when committed.
///
/// # Errors
/// What the file system says.
pub fn stage_csv<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<Staged> {
    stage(path, |out| {
        let mut writer = csv::Writer::from_writer(out);
        for row in rows {
            writer.serialize(row).map_err(std::io::Error::other)?;
        }
        writer.flush()
    })
}

/// Reads the rows of a CSV file with a header.
///
/// # Errors
/// With file, line and what was expected; a file without rows is an error too.
pub fn read_csv<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Vec<T>> {
    read_checked(path, |_, _| Ok(()))
}

/// Reads the rows of a CSV file with a header; `check` judges each with the row before it.
///
/// # Errors
/// With file, line and what was expected; a file without rows is an error too.
pub fn read_checked<T: for<'de> Deserialize<'de>>(
    path: &Path,
    check: impl Fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<T>> {
    read_checked_with(&csv::ReaderBuilder::new(), path, check)
}

/// As [`read_checked`], with the reader that `builder` makes.
///
/// # Errors
/// As [`read_checked`].
pub fn read_checked_with<T: for<'de> Deserialize<'de>>(
    builder: &csv::ReaderBuilder,
    path: &Path,
    check: impl Fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<T>> {
    let mut rows = Vec::new();
    read_records(builder, path, |record| {
        let row = record.read()?;
        check(rows.last(), &row).map_err(|flaw| record.error(flaw))?;
        rows.push(row);
        Ok(())
    })?;
    Ok(rows)
}

/// A line of a CSV file.
pub(crate) struct Record<'a> {
    path: &'a Path,
    headers: &'a csv::StringRecord,
    fields: &'a csv::StringRecord,
}

impl Record<'_> {
    /// Whether the file has a column of this name.
    pub(crate) fn has_column(&self, name: &str) -> bool {
        self.headers.iter().any(|header| header == name)
    }

    /// Its fields by the names of their columns.
    pub(crate) fn read<T: for<'de> Deserialize<'de>>(&self) -> Result<T> {
        self.fields
            .deserialize(Some(self.headers))
            .map_err(|e| csv_error(self.path, &e, Some(self.headers)))
    }

    /// What is wrong with it, with its line.
    pub(crate) fn error(&self, flaw: Flaw) -> Error {
        let line = self.fields.position().map_or(1, csv::Position::line);
        Error::line(self.path, line, flaw.problem, flaw.expected)
    }
}

/// Reads a CSV file with a header, line by line.
///
/// # Errors
/// As [`read_checked`], and what `take` says.
pub(crate) fn read_records(
    builder: &csv::ReaderBuilder,
    path: &Path,
    mut take: impl FnMut(&Record) -> Result<()>,
) -> Result<()> {
    let file = std::fs::File::open(path).map_err(Error::io(path))?;
    let mut reader = builder.from_reader(file);
    let headers = reader
        .headers()
        .map_err(|e| csv_error(path, &e, None))?
        .clone();
    let mut fields = csv::StringRecord::new();
    let mut is_empty = true;
    while reader
        .read_record(&mut fields)
        .map_err(|e| csv_error(path, &e, None))?
    {
        is_empty = false;
        take(&Record {
            path,
            headers: &headers,
            fields: &fields,
        })?;
    }
    if is_empty {
        return Err(Error::content(
            path,
            "no rows; expected a header and at least one row",
        ));
    }
    Ok(())
}

fn csv_error(path: &Path, error: &csv::Error, headers: Option<&csv::StringRecord>) -> Error {
    if let csv::ErrorKind::Io(source) = error.kind() {
        return Error::io(path)(std::io::Error::new(source.kind(), source.to_string()));
    }
    let mut line = error.position().map_or(1, csv::Position::line);
    let problem = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => {
            let column = headers
                .zip(err.field())
                .and_then(|(headers, field)| headers.get(field as usize));
            if column.is_none() {
                // Not one field's fault: a column that is missing or not known.
                line = 1;
            }
            column.map_or_else(
                || err.kind().to_string(),
                |name| format!("{name}: {}", err.kind()),
            )
        }
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("{len} fields under a header of {expected_len}"),
        csv::ErrorKind::Utf8 { .. } => "not text".into(),
        _ => error.to_string(),
    };
    Error::line(
        path,
        line,
        problem,
        "the columns that the README lists, as numbers",
    )
}
