//! Reading and writing a run, CSV or Parquet as its name ends.

use super::cell::{RunCell, RunIdentity};
use super::parquet::{self, Origin};
use super::row::{RunRow, RunRows};
use crate::error::{Error, Result};
use crate::files::csv::read_checked;
use crate::files::output::Writing;
use crate::files::parquet::is_parquet;
use std::path::Path;

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
        parquet::read(path)
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
        return parquet::read_cells(path);
    }
    let cells: Vec<RunCell> = read(path)?.iter().map(RunCell::from).collect();
    let identity = RunIdentity::of(cells.iter().copied());
    Ok((cells, identity))
}
