//! Takes runs into a map, a few in memory at a time.

use super::inputs::{Input, Inputs};
use super::words::describe;
use crate::error::{Error, Result};
use crate::files::run::{self, RunIdentity};
use crate::map::fusion::grade_map::GradeMap;
use crate::map::geometry::network::Network;
use crate::map::io::map_parquet::stage_placed;
use crate::map::io::run_list::RunList;
use crate::map::io::store;
use crate::map::matching::placing::{PlacedRun, place};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Runs that are placed at once, for each thread; as many wait to be added.
const RUNS_A_THREAD: usize = 8;
/// A store is written after this many cells, or after as many as it holds where that is more: so
/// that an interruption costs seconds, and writing does not cost more than adding.
const CELLS_A_SAVE: usize = 10_000_000;

/// What becomes of the runs.
pub(crate) struct Intake<'a, 'r> {
    pub(crate) sums: GradeMap<'r>,
    pub(crate) runs: RunList,
    /// Written now and then, if there is one; else sessions are closed when they are complete.
    pub(crate) store: Option<&'a Path>,
    /// Folder of a road's placed runs.
    pub(crate) placed: Option<PathBuf>,
    pub(crate) tally: Tally,
    open_session: Option<String>,
    cells_since_save: usize,
}

/// How many runs there were of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) added: usize,
    pub(crate) unmatched: usize,
    pub(crate) repeated: usize,
    pub(crate) damaged: usize,
}

/// A run that was read and placed.
struct Arrival {
    identity: RunIdentity,
    /// `None` for one that is in the map.
    placed: Option<PlacedRun>,
}

/// Runs of one session.
struct Batch<'i> {
    inputs: &'i [Input],
    /// Judged in their order: which error is told must not depend on threads.
    arrivals: Vec<Result<Arrival>>,
}

impl<'a, 'r> Intake<'a, 'r> {
    pub(crate) fn new(
        sums: GradeMap<'r>,
        runs: RunList,
        store: Option<&'a Path>,
        placed: Option<PathBuf>,
    ) -> Self {
        Self {
            sums,
            runs,
            store,
            placed,
            tally: Tally::default(),
            open_session: None,
            cells_since_save: 0,
        }
    }

    /// Adds these. Files found in a folder that are damaged are named and left out whole; one
    /// that the command line names is an error, as all are if `strict`.
    pub(crate) fn add(&mut self, inputs: Inputs, strict: bool) -> Result<()> {
        for e in inputs.damaged {
            self.leave_out(e, strict)?;
        }
        let runs = inputs.runs;
        let in_flight = RUNS_A_THREAD * rayon::current_num_threads();
        // What was there at the start: those need not be placed.
        let (road, known) = (self.sums.network(), self.runs.clone());
        let batches = runs
            .chunk_by(|a, b| a.session == b.session)
            .flat_map(|of_session| of_session.chunks(in_flight));
        // While one batch is added, the next is read and placed.
        let mut placed: Option<Batch> = None;
        for batch in batches.map(Some).chain([None]) {
            let before = placed.take();
            let (next, added) = rayon::join(
                || batch.map(|inputs| Batch::place(inputs, road, &known)),
                || before.map_or(Ok(()), |batch| self.add_batch(batch, strict)),
            );
            added?;
            placed = next;
        }
        self.judge(&runs)
    }

    fn add_batch(&mut self, batch: Batch, strict: bool) -> Result<()> {
        let session = batch
            .inputs
            .first()
            .and_then(|input| input.session.as_ref());
        if session != self.open_session.as_ref() {
            if let (Some(complete), None) = (&self.open_session, self.store) {
                self.sums.close_session(complete);
            }
            self.open_session = session.cloned();
        }
        for (input, arrival) in batch.inputs.iter().zip(batch.arrivals) {
            match arrival {
                Ok(arrival) => self.take(input, &arrival)?,
                Err(e) => self.leave_out(e, strict || !input.found)?,
            }
        }
        self.save_now_and_then()
    }

    fn take(&mut self, input: &Input, arrival: &Arrival) -> Result<()> {
        let Arrival { identity, placed } = arrival;
        let path = input.path.display();
        let Some(placed) = placed.as_ref().filter(|_| self.runs.insert(*identity)) else {
            eprintln!("{path}: in the map already, not counted again");
            self.tally.repeated += 1;
            return Ok(());
        };
        eprintln!("{}", describe(&input.path, &placed.coverage));
        let session = input.session.as_deref();
        if let (Some(folder), false) = (&self.placed, placed.cells.is_empty()) {
            let path = folder.join(format!("{identity}.parquet"));
            stage_placed(&path, session, &placed.cells)?.commit()?;
        }
        self.sums.add_placed(session, placed);
        self.cells_since_save += placed.cells.len();
        self.tally.added += 1;
        self.tally.unmatched += usize::from(placed.coverage.matched == 0);
        Ok(())
    }

    fn leave_out(&mut self, e: Error, strict: bool) -> Result<()> {
        if strict {
            return Err(e);
        }
        eprintln!("{e}: left out");
        self.tally.damaged += 1;
        Ok(())
    }

    fn save_now_and_then(&mut self) -> Result<()> {
        let Some(path) = self.store else {
            return Ok(());
        };
        if self.cells_since_save < CELLS_A_SAVE.max(self.sums.held_cells()) {
            return Ok(());
        }
        store::stage(path, &self.sums, &self.runs)?.commit()?;
        eprintln!("{}: {} runs so far", path.display(), self.runs.len());
        self.cells_since_save = 0;
        Ok(())
    }

    /// Whether there is something to make a map of; says what was left out.
    fn judge(&self, runs: &[Input]) -> Result<()> {
        let Tally {
            added,
            unmatched,
            repeated,
            damaged,
        } = self.tally;
        let Some(first) = runs.first() else {
            return Ok(());
        };
        if added > 0 && added == unmatched {
            return Err(Error::content(
                &first.path,
                format!(
                    "neither this nor another of {unmatched} runs covers a cell of the road; \
                     expected runs over the road, in its direction"
                ),
            ));
        }
        if unmatched > 0 {
            eprintln!("warning: {unmatched} of {added} runs gave nothing");
        }
        if repeated > 0 {
            eprintln!("warning: {repeated} runs were in the map already");
        }
        if damaged > 0 {
            eprintln!("warning: {damaged} files were damaged and left out, {added} runs added");
        }
        Ok(())
    }
}

impl<'i> Batch<'i> {
    fn place(inputs: &'i [Input], road: &Network, known: &RunList) -> Self {
        let arrive = |input: &Input| {
            let (cells, identity) = run::read_cells(&input.path)?;
            let placed = (!known.contains(identity)).then(|| place(road, &cells));
            Ok(Arrival { identity, placed })
        };
        Self {
            inputs,
            arrivals: inputs.par_iter().map(arrive).collect(),
        }
    }
}
