//! Reading and writing of runs, CSV or Parquet by the extension of the file.

use super::cell::{RunCell, RunIdentity, check_density};
use super::parquet::{self, Origin};
use super::row::{RunRow, RunRows};
use crate::error::{Error, Result};
use crate::files::csv::{read_checked, read_records};
use crate::files::limits;
use crate::files::output::Writing;
use crate::files::parquet::is_parquet;
use std::path::Path;

/// Writes a run: as Parquet if the name ends in .parquet, else as CSV.
///
/// # Errors
/// Returns the error of the file system.
pub fn write(path: &Path, rows: &[RunRow]) -> Result<()> {
    write_from(path, rows, &Origin::default())
}

/// Writes a run as [`write()`] does, with its origin (Parquet only).
///
/// # Errors
/// Returns the error of the file system.
pub fn write_from(path: &Path, mut rows: &[RunRow], origin: &Origin) -> Result<()> {
    write_rows(path, &mut rows, origin)
}

/// Writes a run as [`write_from`] does; the rows need not be in memory.
///
/// # Errors
/// Returns the error of the file system or of the rows.
pub fn write_rows(path: &Path, rows: &mut dyn RunRows, origin: &Origin) -> Result<()> {
    if is_parquet(path) {
        return parquet::stage(path, &mut Rounded(rows), origin)?.commit();
    }
    let mut writing = Writing::begin(path)?;
    let mut writer = csv::Writer::from_writer(&mut writing);
    let failed = |e: csv::Error| Error::io(path)(e.into());
    Rounded(rows).each(&mut |row| writer.serialize(row).map_err(failed))?;
    writer.flush().map_err(Error::io(path))?;
    drop(writer);
    writing.finish()?.commit()
}

/// Rows rounded as files have them.
struct Rounded<'a>(&'a mut dyn RunRows);

impl RunRows for Rounded<'_> {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        self.0.each(&mut |row| take(&row.rounded()))
    }
}

/// Reads a run, CSV or Parquet.
///
/// # Errors
/// Names the file, the line and what was expected.
pub fn read(path: &Path) -> Result<Vec<RunRow>> {
    if is_parquet(path) {
        parquet::read(path)
    } else {
        let rows = read_checked(path, RunRow::check)?;
        for count in 1..=rows.len() {
            check_density(count, |i| rows[i].distance_m).map_err(|flaw| {
                // The header is line 1.
                Error::line(path, count as u64 + 1, flaw.problem, flaw.expected)
            })?;
        }
        Ok(rows)
    }
}

/// Reads the columns of a run that fusion needs, CSV or Parquet.
///
/// # Errors
/// Names the file, the line and what was expected.
pub fn read_cells(path: &Path) -> Result<(Vec<RunCell>, RunIdentity)> {
    if is_parquet(path) {
        return parquet::read_cells(path);
    }
    let mut cells: Vec<RunCell> = Vec::new();
    let mut before: Option<RunRow> = None;
    read_records(&csv::ReaderBuilder::new(), path, |record| {
        let row = record.read()?;
        RunRow::check(before.as_ref(), &row).map_err(|flaw| record.error(flaw))?;
        if cells.len() == limits::ROWS {
            return Err(limits::too_many_rows(path, limits::ROWS));
        }
        cells.push(RunCell::from(&row));
        check_density(cells.len(), |i| cells[i].distance_m).map_err(|flaw| record.error(flaw))?;
        before = Some(row);
        Ok(())
    })?;
    let identity = RunIdentity::of(cells.iter().copied());
    Ok((cells, identity))
}
