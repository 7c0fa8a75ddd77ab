//! Memory for the cells of a run, which the next run uses again.

use crate::error::Result;
use crate::files::run::{RunCell, RunIdentity, read_cells_into};
use std::path::Path;

/// Cells whose memory is kept. That of a longer run goes back, so that each thread holds 8 MB at most.
const CELLS_KEPT: usize = 100_000;

/// Memory for the cells of a run: to ask the system for it anew for each run takes as long as the
/// decoding of the run.
#[derive(Default)]
pub(super) struct CellBuffer(Vec<RunCell>);

impl CellBuffer {
    /// Reads the cells of a run and passes them, with its identity, to `work`.
    ///
    /// # Errors
    /// Returns the error of the file, or that of `work`.
    pub(super) fn read<R>(
        &mut self,
        path: &Path,
        work: impl FnOnce(&[RunCell], RunIdentity) -> Result<R>,
    ) -> Result<R> {
        let Self(cells) = self;
        let result = read_cells_into(cells, path).and_then(|identity| work(cells, identity));
        cells.clear();
        cells.shrink_to(CELLS_KEPT);
        result
    }
}
