//! Which runs are in a map: so that none counts twice, and an interrupted fusion goes on.

use crate::error::{Error, Result};
use crate::files::run::RunIdentity;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

/// What the line of a run begins with; a comment to the reader of the rows.
const RUN_MARK: &str = "# run ";

/// The runs of a map, 16 bytes each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunList(BTreeSet<RunIdentity>);

impl RunList {
    /// Adds a run; `false` if it was there already.
    pub fn insert(&mut self, run: RunIdentity) -> bool {
        self.0.insert(run)
    }

    /// Whether a run is there.
    pub fn contains(&self, run: RunIdentity) -> bool {
        self.0.contains(&run)
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// One line each, behind the rows of a store.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.0
            .iter()
            .try_for_each(|run| writeln!(out, "{RUN_MARK}{run}"))
    }

    /// Those of a store, which promises this many.
    pub(crate) fn read(path: &Path, promised: usize) -> Result<Self> {
        let file = File::open(path).map_err(Error::io(path))?;
        let mut runs = Self::default();
        for (number, line) in (1..).zip(BufReader::new(file).split(b'\n')) {
            let line = line.map_err(Error::io(path))?;
            let Some(run) = line.strip_prefix(RUN_MARK.as_bytes()) else {
                continue;
            };
            let run = std::str::from_utf8(run)
                .ok()
                .and_then(|run| run.parse().ok());
            if !run.is_some_and(|run| runs.insert(run)) {
                let problem = "not a run, or one that was there already";
                return Err(Error::line(
                    path,
                    number,
                    problem,
                    "the line as it was written",
                ));
            }
        }
        if runs.len() != promised {
            let found = runs.len();
            let problem = format!("{found} runs; expected the {promised} of its first line");
            return Err(Error::content(path, problem));
        }
        Ok(runs)
    }
}
