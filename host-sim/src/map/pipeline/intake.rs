//! Adds runs to a map, a few in memory at a time.

use super::cell_buffer::CellBuffer;
use super::in_order::{Item, in_order};
use super::inputs::{Inputs, RunInput};
use super::words::{report_coverage, report_left_out};
use crate::error::{Error, Result, on_one_line};
use crate::files::output::Staged;
use crate::files::run::RunIdentity;
use crate::files::stop::Stop;
use crate::map::fusion::grade_map::GradeMap;
use crate::map::io::placed_file::PlacedFolder;
use crate::map::io::run_list::RunList;
use crate::map::io::store;
use crate::map::io::store_file::StoreFile;
use crate::map::matching::placing::{PlacedRun, place};
use crate::terminal::print::{alert, note};

/// Rows of runs that are in memory at the same time: read, placed, or waiting to be added.
pub(super) const ROWS_IN_FLIGHT: usize = 1_000_000;
/// A store is written after this many cells, or after as many as it holds if that is more. An
/// interruption then costs seconds of work, and writing takes no longer than adding.
const CELLS_A_SAVE: usize = 10_000_000;

/// The runs of a fusion.
pub(crate) struct RunIntake<'a, 'r> {
    pub(crate) sums: GradeMap<'r>,
    pub(crate) runs: RunList,
    /// The store, written from time to time. Without a store, complete sessions are closed.
    pub(crate) store: Option<&'a mut StoreFile>,
    pub(crate) placed: Option<PlacedFolder>,
    pub(crate) tally: RunTally,
    open_session: Option<String>,
    cells_since_save: usize,
}

/// Number of runs of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct RunTally {
    pub(crate) added: usize,
    pub(crate) unmatched: usize,
    pub(crate) repeated: usize,
    pub(crate) damaged: usize,
}

impl Item for RunInput {
    fn cost(&self) -> usize {
        // A file without rows takes some memory too.
        self.rows.max(1)
    }
}

/// A run that was read and placed.
struct Arrival {
    identity: RunIdentity,
    /// `None` for a run that is already in the map.
    placed: Option<PlacedRun>,
    /// Its file among the placed runs.
    staged: Option<Staged>,
}

impl<'a, 'r> RunIntake<'a, 'r> {
    pub(crate) fn new(
        sums: GradeMap<'r>,
        runs: RunList,
        store: Option<&'a mut StoreFile>,
        placed: Option<PlacedFolder>,
    ) -> Self {
        Self {
            sums,
            runs,
            store,
            placed,
            tally: RunTally::default(),
            open_session: None,
            cells_since_save: 0,
        }
    }

    /// Adds runs. Damaged files found in a folder are reported and left out. A damaged file of the
    /// command line is an error, and so is any damaged file if `strict`.
    pub(crate) fn add(&mut self, inputs: Inputs, strict: bool, stop: &Stop) -> Result<()> {
        for e in inputs.damaged {
            self.leave_out(e, strict)?;
        }
        let runs = inputs.runs;
        // Runs that were in the map at the start need not be placed.
        let (road, known) = (self.sums.network(), self.runs.clone());
        let folder = self.placed.clone();
        let arrive = |input: &RunInput, buffer: &mut CellBuffer| {
            stop.check()?;
            buffer.read(&input.path, |cells, identity| {
                let placed = (!known.contains(identity)).then(|| place(road, cells));
                let covering = placed.as_ref().filter(|placed| !placed.cells.is_empty());
                let staged = folder.as_ref().zip(covering).map(|(folder, placed)| {
                    folder.stage(identity, input.session.as_deref(), road, &placed.cells)
                });
                Ok(Arrival {
                    identity,
                    placed,
                    staged: staged.transpose()?,
                })
            })
        };
        in_order(&runs, ROWS_IN_FLIGHT, arrive, |input, arrival| {
            stop.check()?;
            self.add_arrival(input, arrival, strict)
        })?;
        self.judge(&runs)
    }

    fn add_arrival(
        &mut self,
        input: &RunInput,
        arrival: Result<Arrival>,
        strict: bool,
    ) -> Result<()> {
        if input.session != self.open_session {
            if let (Some(complete), None) = (&self.open_session, &self.store) {
                self.sums.close_session(complete);
            }
            self.open_session.clone_from(&input.session);
        }
        match arrival {
            Ok(arrival) => self.take(input, arrival)?,
            Err(e) => self.leave_out(e, strict || !input.found)?,
        }
        self.save_now_and_then()
    }

    fn take(&mut self, input: &RunInput, arrival: Arrival) -> Result<()> {
        let Arrival {
            identity,
            placed,
            staged,
        } = arrival;
        let path = on_one_line(&input.path);
        let Some(placed) = placed.filter(|_| self.runs.insert(identity)) else {
            note(format_args!(
                "{path}: already in the map, not counted again"
            ));
            self.tally.repeated += 1;
            return Ok(());
        };
        report_coverage(&input.path, &placed.coverage);
        if let Some(staged) = staged {
            staged.commit()?;
        }
        self.sums.add_placed(input.session.as_deref(), &placed);
        self.cells_since_save += placed.cells.len();
        self.tally.added += 1;
        self.tally.unmatched += usize::from(placed.coverage.matched == 0);
        Ok(())
    }

    fn leave_out(&mut self, e: Error, strict: bool) -> Result<()> {
        report_left_out(e, strict)?;
        self.tally.damaged += 1;
        Ok(())
    }

    fn save_now_and_then(&mut self) -> Result<()> {
        let Some(file) = &mut self.store else {
            return Ok(());
        };
        if self.cells_since_save < CELLS_A_SAVE.max(self.sums.held_cells()) {
            return Ok(());
        }
        let staged = store::stage(file.path(), &self.sums, &self.runs)?;
        file.replace(staged)?;
        let path = file.path();
        note(format_args!(
            "{}: {} runs so far",
            on_one_line(path),
            self.runs.len()
        ));
        self.cells_since_save = 0;
        Ok(())
    }

    /// Checks that the map is not empty, and prints what was left out.
    fn judge(&self, runs: &[RunInput]) -> Result<()> {
        let RunTally {
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
            alert(format_args!(
                "warning: {unmatched} of {added} runs cover no cell"
            ));
        }
        if repeated > 0 {
            alert(format_args!(
                "warning: {repeated} runs were already in the map"
            ));
        }
        if damaged > 0 {
            alert(format_args!(
                "warning: {damaged} damaged files left out, {added} runs added"
            ));
        }
        Ok(())
    }
}
