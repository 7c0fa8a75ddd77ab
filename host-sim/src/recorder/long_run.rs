//! What a drive leaves.

use crate::error::{Error, Result};
use crate::files::run::{RunRow, RunRows};
use crate::files::spool::{Spool, blocks};
use estimator_core::{Counters, PersistentState};
use std::io;

/// A whole drive, smoothed.
#[derive(Debug)]
pub struct Run {
    /// Its cells.
    pub rows: Vec<RunRow>,
    /// What happened on the way.
    pub counters: Counters,
    /// What it leaves for the next drive, if it was long enough.
    pub kept: Option<PersistentState>,
}

/// A whole drive, smoothed, that need not fit into memory.
#[derive(Debug)]
pub struct LongRun {
    /// Its cells.
    pub rows: Rows,
    /// What happened on the way.
    pub counters: Counters,
    /// What it leaves for the next drive, if it was long enough.
    pub kept: Option<PersistentState>,
}

impl LongRun {
    /// The same with all rows in memory.
    ///
    /// # Errors
    /// What the file system says, where the rows are in a temporary file.
    pub fn in_memory(mut self) -> Result<Run> {
        let mut rows = Vec::with_capacity(self.rows.count());
        self.rows.each(&mut |row| {
            rows.push(*row);
            Ok(())
        })?;
        Ok(Run {
            rows,
            counters: self.counters,
            kept: self.kept,
        })
    }
}

/// Bytes of a row.
const ROW_SLOT: usize = 128;

/// The rows of a run, in memory or in a temporary file.
#[derive(Debug, Default)]
pub struct Rows(Spool<RunRow, ROW_SLOT>);

impl Rows {
    /// How many there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.0.count()
    }

    /// Stores rows at their numbers.
    pub(super) fn put(
        &mut self,
        first: usize,
        rows: impl Iterator<Item = RunRow>,
    ) -> io::Result<()> {
        self.0.put(first, rows)
    }
}

impl RunRows for Rows {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        for block in blocks(0..self.count()) {
            for row in self.0.read(block).map_err(no_room)? {
                take(&row)?;
            }
        }
        Ok(())
    }
}

/// The temporary file of a drive could not be written or read back.
pub(super) fn no_room(error: io::Error) -> Error {
    Error::io(&std::env::temp_dir())(error)
}
