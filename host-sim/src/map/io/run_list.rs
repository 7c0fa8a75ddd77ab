//! The list of runs in a map. It prevents counting a run twice, and an interrupted fusion can
//! continue from it.

use crate::error::{Error, Result};
use crate::files::limits;
use crate::files::run::RunIdentity;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

/// Prefix of the line of a run; a comment for the reader of the rows.
const RUN_MARK: &str = "# run ";

/// The identities of the runs of a map, 16 bytes each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunList(BTreeSet<RunIdentity>);

impl RunList {
    /// Adds a run. Returns `false` if it is already in the list.
    pub fn insert(&mut self, run: RunIdentity) -> bool {
        self.0.insert(run)
    }

    /// Returns true if the run is in the list.
    pub fn contains(&self, run: RunIdentity) -> bool {
        self.0.contains(&run)
    }

    /// Returns the number of runs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns true if the list is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Writes one line per run, after the rows of a store.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.0
            .iter()
            .try_for_each(|run| writeln!(out, "{RUN_MARK}{run}"))
    }

    /// Reads the list of a store. Its first line states the number of runs, `promised`.
    pub(crate) fn read(path: &Path, promised: usize) -> Result<Self> {
        let file = File::open(path).map_err(Error::io(path))?;
        let mut reader = BufReader::new(file);
        let mut runs = Self::default();
        let mut line = Vec::new();
        for number in 1.. {
            line.clear();
            let most = limits::RECORD_BYTES as u64;
            let count = reader.by_ref().take(most).read_until(b'\n', &mut line);
            if count.map_err(Error::io(path))? == 0 {
                break;
            }
            let text = line.strip_suffix(b"\n").unwrap_or(&line);
            // The first line and the rows are read by others.
            if number == 1 || !text.starts_with(b"#") {
                continue;
            }
            let run = text.strip_prefix(RUN_MARK.as_bytes());
            let run = run.and_then(|run| std::str::from_utf8(run).ok()?.parse().ok());
            if !run.is_some_and(|run| runs.insert(run)) {
                let problem = "not a run, or a run that is already listed";
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
