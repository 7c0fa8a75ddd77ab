//! Placing of run files on a road or a network, for an engine that sums them.
//!
//! Each run is placed by itself, and its file has the run's name. So runs can be spread over
//! processes and machines, and a process that was interrupted can be started again.

use super::cell_buffer::CellBuffer;
use super::in_order::in_order;
use super::inputs::{Inputs, NamedSession, RunInput};
use super::intake::ROWS_IN_FLIGHT;
use super::words::{report_coverage, report_left_out};
use crate::error::{Error, Result, on_one_line};
use crate::files::output::Staged;
use crate::files::run;
use crate::map::geometry::network::Network;
use crate::map::io::network_file;
use crate::map::io::placed_file::PlacedFolder;
use crate::map::matching::placing::{Coverage, place};
use crate::terminal::print::note;
use std::path::{Path, PathBuf};

/// Options of placing.
#[derive(Clone, Copy, Debug)]
pub struct PlaceRequest<'a> {
    /// Run files, or folders of them; each run is a session of its own unless it names one.
    pub runs: &'a [PathBuf],
    /// Runs of named sessions.
    pub sessions: &'a [NamedSession],
    /// File of the road or the network.
    pub road: &'a Path,
    /// Folder for the placed runs.
    pub out: &'a Path,
    /// True if a damaged file in a folder is an error.
    pub strict: bool,
}

/// Number of runs of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaceTally {
    /// Placed and written.
    pub placed: usize,
    /// There already, from before.
    pub there: usize,
    /// Without a cell on the road.
    pub unmatched: usize,
    /// Damaged, and left out.
    pub damaged: usize,
    /// Cells that were written.
    pub cells: usize,
}

/// What became of a run.
enum Outcome {
    There,
    Placed(Coverage, usize, Option<Staged>),
}

/// Places runs on a road, and writes a file for each that has a cell on it.
///
/// # Errors
/// Returns an error if a file cannot be read or used. Runs that were placed before it stay.
pub fn place_files(request: &PlaceRequest) -> Result<PlaceTally> {
    let inputs = Inputs::of(request.runs, request.sessions)?;
    let network = network_file::read(request.road)?;
    let road = request.road.file_stem().unwrap_or_default();
    let folder = PlacedFolder::new(request.out, &road.to_string_lossy(), &network);
    let mut tally = PlaceTally::default();
    for e in inputs.damaged {
        tally.leave_out(e, request.strict)?;
    }
    let arrive =
        |input: &RunInput, buffer: &mut CellBuffer| outcome(input, buffer, &network, &folder);
    in_order(
        &inputs.runs,
        ROWS_IN_FLIGHT,
        arrive,
        |input, outcome| match outcome {
            Ok(outcome) => tally.take(&input.path, outcome),
            Err(e) => tally.leave_out(e, request.strict || !input.found),
        },
    )?;
    Ok(tally)
}

/// Places a run, unless it is there.
fn outcome(
    input: &RunInput,
    buffer: &mut CellBuffer,
    network: &Network,
    folder: &PlacedFolder,
) -> Result<Outcome> {
    let path = &input.path;
    // A run as Parquet names its identity; one as CSV must be read.
    let known = run::identity(path)?.map(|run| folder.has(run));
    if known.transpose()? == Some(true) {
        return Ok(Outcome::There);
    }
    buffer.read(path, |cells, identity| {
        let placed = place(network, cells);
        let session = input.session.as_deref();
        let is_empty = placed.cells.is_empty();
        let staged = (!is_empty).then(|| folder.stage(identity, session, network, &placed.cells));
        Ok(Outcome::Placed(
            placed.coverage,
            placed.cells.len(),
            staged.transpose()?,
        ))
    })
}

impl PlaceTally {
    fn take(&mut self, path: &Path, outcome: Outcome) -> Result<()> {
        let (coverage, cells, staged) = match outcome {
            Outcome::There => {
                note(format_args!("{}: there already", on_one_line(path)));
                self.there += 1;
                return Ok(());
            }
            Outcome::Placed(coverage, cells, staged) => (coverage, cells, staged),
        };
        report_coverage(path, &coverage);
        match staged {
            Some(staged) => {
                staged.commit()?;
                self.placed += 1;
            }
            None => self.unmatched += 1,
        }
        self.cells += cells;
        Ok(())
    }

    fn leave_out(&mut self, e: Error, is_error: bool) -> Result<()> {
        report_left_out(e, is_error)?;
        self.damaged += 1;
        Ok(())
    }
}
