//! Which runs a command line means: files and folders, and the session of each.

use crate::error::{Error, Result};
use crate::files::parquet::is_parquet;
use crate::files::run;
use std::fs;
use std::path::{Path, PathBuf};

/// One run to fuse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Input {
    /// `None` is a session of its own.
    pub(crate) session: Option<String>,
    pub(crate) path: PathBuf,
    /// Found in a folder: if it is damaged, the others go on without it.
    pub(crate) found: bool,
}

/// All runs to fuse.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// In the order in which they are added: runs without a session, then session by session, so
    /// that each can be closed before the next.
    pub(crate) runs: Vec<Input>,
    /// Why files found in folders could not be opened.
    pub(crate) damaged: Vec<Error>,
}

impl Inputs {
    /// Adds a run, or all runs in a folder and its folders, in the order of their names. A
    /// session that is told here counts before the one that a file tells.
    pub(crate) fn add(&mut self, path: &Path, session: Option<&str>) -> Result<()> {
        if !path.is_dir() {
            let input = Input {
                session: session.map(str::to_owned),
                path: path.to_owned(),
                found: false,
            };
            return self.push(input);
        }
        let before = self.runs.len() + self.damaged.len();
        for path in files_below(path)? {
            self.push(Input {
                session: session.map(str::to_owned),
                path,
                found: true,
            })?;
        }
        if self.runs.len() + self.damaged.len() == before {
            let problem = "no runs in this folder; expected files that end in .parquet or .csv";
            return Err(Error::content(path, problem));
        }
        Ok(())
    }

    /// Puts the runs in order.
    pub(crate) fn sort(&mut self) {
        self.runs.sort_by(|a, b| a.session.cmp(&b.session));
    }

    fn push(&mut self, mut input: Input) -> Result<()> {
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

/// Runs in a folder and the folders in it, by name. Names that begin with `.` or `_` are not
/// data: so Spark and Hive have it.
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
