//! The runs of a command line: files and folders, with their sessions.

use crate::error::{Error, Result};
use crate::files::parquet::is_parquet;
use crate::files::run;
use std::fs;
use std::path::{Path, PathBuf};

/// One run to fuse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RunInput {
    /// `None` is a session of its own.
    pub(crate) session: Option<String>,
    pub(crate) path: PathBuf,
    /// True if found in a folder: a damaged file is then left out.
    pub(crate) found: bool,
}

/// All runs to fuse.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// In the order of adding: runs without a session, then session by session, so that each can be
    /// closed before the next.
    pub(crate) runs: Vec<RunInput>,
    /// Errors of files found in folders that could not be opened.
    pub(crate) damaged: Vec<Error>,
}

impl Inputs {
    /// Adds a run, or all runs in a folder and its subfolders, in the order of their names.
    /// `session` takes precedence over the session that a file names.
    pub(crate) fn add(&mut self, path: &Path, session: Option<&str>) -> Result<()> {
        if !path.is_dir() {
            let input = RunInput {
                session: session.map(str::to_owned),
                path: path.to_owned(),
                found: false,
            };
            return self.push(input);
        }
        let before = self.runs.len() + self.damaged.len();
        for path in files_below(path)? {
            self.push(RunInput {
                session: session.map(str::to_owned),
                path,
                found: true,
            })?;
        }
        if self.runs.len() + self.damaged.len() == before {
            let problem = "no runs in this folder; expected .parquet or .csv files";
            return Err(Error::content(path, problem));
        }
        Ok(())
    }

    /// Sorts the runs.
    pub(crate) fn sort(&mut self) {
        self.runs.sort_by(|a, b| a.session.cmp(&b.session));
    }

    fn push(&mut self, mut input: RunInput) -> Result<()> {
        if input.session.is_none() && is_parquet(&input.path) {
            match run::session(&input.path) {
                Ok(session) => input.session = session,
                Err(e) if input.found => {
                    self.damaged.push(e);
                    return Ok(());
                }
                Err(e) => return Err(e),
            }
        }
        self.runs.push(input);
        Ok(())
    }
}

/// Returns the runs in a folder and its subfolders, by name. Names that begin with `.` or `_` are
/// not data, as in Spark and Hive.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut entries = fs::read_dir(folder)
        .and_then(|entries| {
            entries
                .map(|entry| Ok(entry?.path()))
                .collect::<std::io::Result<Vec<_>>>()
        })
        .map_err(Error::io(folder))?;
    entries.sort();
    let mut files = Vec::new();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(['.', '_']) {
            continue;
        }
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else if is_parquet(&path) || path.extension().is_some_and(|end| end == "csv") {
            files.push(path);
        }
    }
    Ok(files)
}
