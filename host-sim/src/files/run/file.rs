//! Reading and writing of runs, CSV or Parquet by the extension of the file.

use super::cell::{Density, RunCell, RunHash, RunIdentity};
use super::parquet::{self, Origin};
use super::row::{RunRow, RunRows};
use crate::error::Result;
use crate::files::csv::{CsvTable, read_records};
use crate::files::kind::{self, Kind};
use crate::files::limits;
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
    let mut table = CsvTable::begin(path)?;
    Rounded(rows).each(&mut |row| table.push(row))?;
    table.finish()?.commit()
}

/// Returns a run as a table in memory: columns, values and metadata of RUN.parquet.
///
/// # Errors
/// Returns the error of the rows.
#[cfg(feature = "parquet")]
pub fn table(rows: &mut dyn RunRows, origin: &Origin) -> Result<arrow_array::RecordBatch> {
    parquet::in_memory(&mut Rounded(rows), origin)
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
/// Returns an error that names the file, the line and the expected value.
pub fn read(path: &Path) -> Result<Vec<RunRow>> {
    if is_parquet(path) {
        return parquet::read(path);
    }
    let mut rows: Vec<RunRow> = Vec::new();
    let mut density = Density::default();
    read_records(&csv::ReaderBuilder::new(), path, |record| {
        let row = record.read()?;
        RunRow::check(rows.last(), &row)
            .and_then(|()| density.check(row.distance_m))
            .map_err(|flaw| record.error(flaw))?;
        limits::push(&mut rows, row, limits::rows_in_memory::<RunRow>(), path)
    })
    .map_err(|e| kind::explained(e, path, &[Kind::Run]))?;
    Ok(rows)
}

/// Reads the columns of a run that fusion needs, CSV or Parquet.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub fn read_cells(path: &Path) -> Result<(Vec<RunCell>, RunIdentity)> {
    let mut cells = Vec::new();
    let identity = read_cells_into(&mut cells, path)?;
    Ok((cells, identity))
}

/// Reads as [`read_cells`] does, into the memory of cells that are of no more use. After an error
/// the cells are some of the file's.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub(crate) fn read_cells_into(cells: &mut Vec<RunCell>, path: &Path) -> Result<RunIdentity> {
    cells.clear();
    let most = limits::rows_in_memory::<RunCell>();
    let mut keep = |cell| limits::push(cells, cell, most, path);
    if is_parquet(path) {
        parquet::each_cell(path, most, keep)
    } else {
        each_cell_of_csv(path, &mut keep)
    }
}

/// Returns the identity that a run as Parquet names; `None` for a run as CSV, which must be read.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub fn identity(path: &Path) -> Result<Option<RunIdentity>> {
    if is_parquet(path) {
        parquet::identity(path)
    } else {
        Ok(None)
    }
}

/// Passes the cells of a run, as [`read_cells`] reads them, to `take`. None is kept, so the run may
/// have any number.
///
/// # Errors
/// Names the file, the line and what was expected.
pub fn each_cell(path: &Path, take: &mut dyn FnMut(RunCell) -> Result<()>) -> Result<RunIdentity> {
    if is_parquet(path) {
        parquet::each_cell(path, usize::MAX, take)
    } else {
        each_cell_of_csv(path, take)
    }
}

fn each_cell_of_csv(
    path: &Path,
    take: &mut dyn FnMut(RunCell) -> Result<()>,
) -> Result<RunIdentity> {
    let mut hash = RunHash::default();
    let mut density = Density::default();
    let mut before: Option<RunRow> = None;
    read_records(&csv::ReaderBuilder::new(), path, |record| {
        let row = record.read()?;
        RunRow::check(before.as_ref(), &row)
            .and_then(|()| density.check(row.distance_m))
            .map_err(|flaw| record.error(flaw))?;
        let cell = RunCell::from(&row);
        before = Some(row);
        hash.add(&cell);
        take(cell)
    })
    .map_err(|e| kind::explained(e, path, &[Kind::Run]))?;
    Ok(hash.identity())
}
