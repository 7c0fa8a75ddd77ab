//! The runs of a command line: files and folders, with their sessions.

use crate::error::{Error, Result};
use crate::files::folder::Folder;
use crate::files::parquet::is_parquet;
use crate::files::row_check::Flaw;
use crate::files::run;
use crate::map::io::session_name::check_session_name;
use crate::terminal::print::note;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Fewest bytes of a row of RUN.csv, about.
const BYTES_A_ROW: usize = 40;

/// Runs of one vehicle in one named session.
#[derive(Clone, Debug)]
pub struct NamedSession {
    /// Name of the session.
    pub name: String,
    /// Run files, or folders of them.
    pub runs: Vec<PathBuf>,
}

/// One run to fuse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RunInput {
    /// `None` is a session of its own.
    pub(crate) session: Option<String>,
    pub(crate) path: PathBuf,
    /// True if found in a folder: a damaged file is then left out.
    pub(crate) found: bool,
    /// Rows that the file may have.
    pub(crate) rows: usize,
}

impl RunInput {
    /// Returns true if the file is a run.
    pub(crate) fn is_readable(&self) -> bool {
        run::each_cell(&self.path, &mut |_| Ok(())).is_ok()
    }
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
    /// Returns these runs, each a session of its own unless it names one, and those of sessions.
    pub(crate) fn of(runs: &[PathBuf], sessions: &[NamedSession]) -> Result<Self> {
        let mut inputs = Self::default();
        for path in runs {
            inputs.add(path, None)?;
        }
        for session in sessions {
            for path in &session.runs {
                inputs.add(path, Some(&session.name))?;
            }
        }
        inputs.sort();
        Ok(inputs)
    }

    /// Adds a run, or all runs in a folder and its subfolders, in the order of their names.
    /// `session` takes precedence over the session that a file names.
    fn add(&mut self, path: &Path, session: Option<&str>) -> Result<()> {
        if !path.is_dir() {
            if path.metadata().is_ok_and(|found| !found.is_file()) {
                let problem = "a pipe or a device; expected a file, which is read more than once";
                return Err(Error::content(path, problem));
            }
            let input = RunInput {
                session: session.map(str::to_owned),
                path: path.to_owned(),
                found: false,
                rows: 0,
            };
            let outline = outline(&input);
            return self.push(input, outline);
        }
        let before = self.runs.len() + self.damaged.len();
        let found = Folder::read(path, is_run)?;
        found.hidden(path).into_iter().for_each(note);
        self.damaged.extend(found.unreadable);
        let input = |path| RunInput {
            session: session.map(str::to_owned),
            path,
            found: true,
            rows: 0,
        };
        let outlined = found.files.into_par_iter().map(|path| {
            let input = input(path);
            let outline = outline(&input);
            (input, outline)
        });
        for (input, outline) in outlined.collect::<Vec<_>>() {
            self.push(input, outline)?;
        }
        if self.runs.len() + self.damaged.len() == before {
            let problem = "no runs in this folder; expected .parquet or .csv files";
            return Err(Error::content(path, problem));
        }
        Ok(())
    }

    /// Sorts the runs.
    fn sort(&mut self) {
        self.runs.sort_by(|a, b| a.session.cmp(&b.session));
    }

    fn push(&mut self, mut input: RunInput, outline: Result<Outline>) -> Result<()> {
        match outline {
            Ok((session, rows)) => {
                input.session = input.session.or(session);
                input.rows = rows;
            }
            Err(e) if input.found && !e.is_of_the_machine() => {
                self.damaged.push(e);
                return Ok(());
            }
            Err(e) => return Err(e),
        }
        self.runs.push(input);
        Ok(())
    }
}

/// The session that a file names, and its rows.
type Outline = (Option<String>, usize);

/// Returns the session that a file names, if the command line names none, and about how many rows it
/// has.
fn outline(input: &RunInput) -> Result<Outline> {
    let path = &input.path;
    if !is_parquet(path) {
        let bytes = path.metadata().map_or(0, |file| file.len());
        return Ok((
            None,
            usize::try_from(bytes).unwrap_or(usize::MAX) / BYTES_A_ROW,
        ));
    }
    if input.session.is_some() {
        // A damaged file is reported when it is read.
        return Ok((None, run::outline(path).map_or(0, |(_, rows)| rows)));
    }
    let (session, rows) = run::outline(path)?;
    if let Some(name) = &session {
        check_session_name(name).map_err(|Flaw { problem, expected }| {
            Error::content(path, format!("{problem}; expected {expected}"))
        })?;
    }
    Ok((session, rows))
}

/// Returns true if the name is that of a run.
fn is_run(path: &Path) -> bool {
    is_parquet(path) || path.extension().is_some_and(|end| end == "csv")
}
