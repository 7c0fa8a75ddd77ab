//! The runs of a command line: files and folders, with their sessions.

use crate::error::{Error, Result, on_one_line};
use crate::files::lock::is_lock;
use crate::files::parquet::is_parquet;
use crate::files::row_check::Flaw;
use crate::files::run;
use crate::files::temporary::is_temporary;
use crate::map::io::session_name::check_session_name;
use crate::terminal::print::note;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

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
        let found = files_below(path)?;
        found.tell_hidden(path);
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

/// What a folder and its subfolders have.
#[derive(Debug, Default)]
struct Found {
    /// Runs, by name.
    files: Vec<PathBuf>,
    /// What looks like a run, or leads to one, and cannot be read.
    unreadable: Vec<Error>,
    /// Names that begin with `.` or `_`: no data, as in Spark and Hive.
    hidden: Vec<PathBuf>,
}

fn files_below(folder: &Path) -> Result<Found> {
    let mut found = Found::default();
    let mut entries = WalkDir::new(folder)
        .follow_links(true)
        .sort_by_file_name()
        .into_iter();
    while let Some(entry) = entries.next() {
        let entry = match entry {
            Ok(entry) => entry,
            Err(e) => {
                found.take_error(folder, e)?;
                continue;
            }
        };
        let path = entry.path();
        let name = entry.file_name().to_string_lossy();
        if entry.depth() > 0 && name.starts_with(['.', '_']) {
            if entry.file_type().is_dir() {
                entries.skip_current_dir();
            }
            if !is_temporary(path) && !is_lock(path) {
                found.hidden.push(path.to_owned());
            }
        } else if entry.file_type().is_dir() || !is_run(path) {
        } else if entry.file_type().is_file() {
            found.files.push(path.to_owned());
        } else {
            let problem = "a pipe or a device; expected a file";
            found.unreadable.push(Error::content(path, problem));
        }
    }
    Ok(found)
}

impl Found {
    /// Takes an error of the walk: a loop of links, and a link to nowhere, are left out.
    fn take_error(&mut self, folder: &Path, e: walkdir::Error) -> Result<()> {
        let path = e.path().unwrap_or(folder).to_owned();
        if let Some(ancestor) = e.loop_ancestor() {
            let ancestor = on_one_line(ancestor);
            let problem = format!("a link back to {ancestor}; expected folders without a loop");
            self.unreadable.push(Error::content(&path, problem));
            return Ok(());
        }
        let e = Error::io(&path)(e.into());
        if !path.is_symlink() {
            return Err(e);
        }
        if is_run(&path) {
            self.unreadable.push(e);
        }
        Ok(())
    }

    /// Prints how many names were skipped, with the first of them.
    fn tell_hidden(&self, folder: &Path) {
        let Self { hidden, .. } = self;
        if hidden.is_empty() {
            return;
        }
        let first: Vec<String> = hidden
            .iter()
            .take(3)
            .map(|path| on_one_line(path))
            .collect();
        let more = if hidden.len() > first.len() {
            ", …"
        } else {
            ""
        };
        note(format_args!(
            "{}: {} skipped, since the name begins with . or _: {}{more}",
            on_one_line(folder),
            hidden.len(),
            first.join(", ")
        ));
    }
}

/// Returns true if the name is that of a run.
fn is_run(path: &Path) -> bool {
    is_parquet(path) || path.extension().is_some_and(|end| end == "csv")
}
