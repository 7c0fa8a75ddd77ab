//! CSV files with a header. They are written whole or not at all, and errors of reading name the
//! line.

use super::limits::{self, Budget};
use super::output::{Staged, Writing};
use super::row_check::Flaw;
use crate::error::{Error, Result};
use serde::{Deserialize, Deserializer, Serialize};
use std::path::{Path, PathBuf};

/// Deserializes an optional value of a required column (serde takes a missing column for an empty
/// one).
pub(crate) fn column<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    cell: D,
) -> std::result::Result<Option<T>, D::Error> {
    Option::deserialize(cell)
}

/// Writes rows as CSV with a header, whole or not at all.
///
/// # Errors
/// Returns the error of the file system.
pub fn write_csv<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<()> {
    stage_csv(path, rows)?.commit()
}

/// Writes rows as CSV with a header to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage_csv<T: Serialize>(path: &Path, rows: impl IntoIterator<Item = T>) -> Result<Staged> {
    let mut table = CsvTable::begin(path)?;
    for row in rows {
        table.push(&row)?;
    }
    table.finish()
}

/// A CSV file with a header that is written row by row.
pub(crate) struct CsvTable {
    writing: csv::Writer<Writing>,
    path: PathBuf,
}

impl CsvTable {
    /// Begins a file that appears when it is finished and committed.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub(crate) fn begin(path: &Path) -> Result<Self> {
        Ok(Self {
            writing: csv::Writer::from_writer(Writing::begin(path)?),
            path: path.to_owned(),
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub(crate) fn push(&mut self, row: &impl Serialize) -> Result<()> {
        let written = self.writing.serialize(row);
        written.map_err(|e| Error::io(&self.path)(e.into()))
    }

    /// Completes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub(crate) fn finish(self) -> Result<Staged> {
        let writing = self.writing.into_inner();
        let failed = |e: csv::IntoInnerError<_>| Error::io(&self.path)(e.into_error());
        writing.map_err(failed)?.finish()
    }
}

/// Reads the rows of a CSV file with a header.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value; also for a file without
/// rows.
pub fn read_csv<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Vec<T>> {
    read_checked(path, |_, _| Ok(()))
}

/// Reads the rows of a CSV file with a header; `check` gets each row with the row before it.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value; also for a file without
/// rows.
pub fn read_checked<T: for<'de> Deserialize<'de>>(
    path: &Path,
    check: impl Fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<T>> {
    let most = limits::rows_in_memory::<T>();
    read_checked_with(&csv::ReaderBuilder::new(), path, most, check)
}

/// Reads at most `most` rows as [`read_checked`] does, with the reader that `builder` makes.
///
/// # Errors
/// Returns the errors of [`read_checked`].
pub fn read_checked_with<T: for<'de> Deserialize<'de>>(
    builder: &csv::ReaderBuilder,
    path: &Path,
    most: usize,
    check: impl Fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<T>> {
    let mut rows = Vec::new();
    read_records(builder, path, |record| {
        let row = record.read()?;
        check(rows.last(), &row).map_err(|flaw| record.error(flaw))?;
        limits::push(&mut rows, row, most, path)
    })?;
    Ok(rows)
}

/// One record of a CSV file.
pub(crate) struct Record<'a> {
    path: &'a Path,
    headers: &'a csv::StringRecord,
    fields: &'a csv::StringRecord,
}

impl Record<'_> {
    /// Returns true if the file has a column of this name.
    pub(crate) fn has_column(&self, name: &str) -> bool {
        self.headers.iter().any(|header| header == name)
    }

    /// Deserializes the fields by the names of their columns.
    pub(crate) fn read<T: for<'de> Deserialize<'de>>(&self) -> Result<T> {
        self.fields
            .deserialize(Some(self.headers))
            .map_err(|e| csv_error(self.path, e, Some(self.headers)))
    }

    /// Returns the error of a flaw, with file and line.
    pub(crate) fn error(&self, flaw: Flaw) -> Error {
        let line = self.fields.position().map_or(1, csv::Position::line);
        Error::line(self.path, line, flaw.problem, flaw.expected)
    }
}

/// Reads a CSV file with a header, record by record.
///
/// # Errors
/// Returns the errors of [`read_checked`], and those of `take`.
pub(crate) fn read_records(
    builder: &csv::ReaderBuilder,
    path: &Path,
    mut take: impl FnMut(&Record) -> Result<()>,
) -> Result<()> {
    let file = std::fs::File::open(path).map_err(Error::io(path))?;
    let file = Budget::new(file, limits::RECORD_BYTES, "record");
    let mut reader = builder.from_reader(file);
    let headers = reader
        .headers()
        .map_err(|e| csv_error(path, e, None))?
        .clone();
    let mut fields = csv::StringRecord::new();
    let mut is_empty = true;
    loop {
        reader.get_mut().renew();
        let is_read = reader
            .read_record(&mut fields)
            .map_err(|e| csv_error(path, e, None))?;
        if !is_read {
            break;
        }
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

/// Returns what is wrong with the columns, without the list of all columns and in words of tables.
fn problem_of_columns(words: &str) -> String {
    let problem = words.split(", expected one of").next().unwrap_or(words);
    problem
        .replace("unknown field", "unknown column")
        .replace("missing field", "no column")
}

fn csv_error(path: &Path, error: csv::Error, headers: Option<&csv::StringRecord>) -> Error {
    let mut line = error.position().map_or(1, csv::Position::line);
    let words = error.to_string();
    let problem = match error.into_kind() {
        csv::ErrorKind::Io(source) => return Error::io(path)(source),
        csv::ErrorKind::Deserialize { err, .. } => {
            let column = headers
                .zip(err.field())
                .and_then(|(headers, field)| headers.get(field as usize));
            if column.is_none() {
                // The error is not in one field: a column is missing or unknown.
                line = 1;
            }
            column.map_or_else(
                || problem_of_columns(&err.kind().to_string()),
                |name| format!("{name}: {}", err.kind()),
            )
        }
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("{len} fields under a header of {expected_len}"),
        csv::ErrorKind::Utf8 { .. } => "not text".into(),
        _ => words,
    };
    Error::line(
        path,
        line,
        problem,
        "the columns of docs/formats.md, as numbers",
    )
}
