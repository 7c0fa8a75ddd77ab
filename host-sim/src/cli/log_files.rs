//! Logs that a command reads more than once.

use crate::error::{Error, Result};
use crate::files::folder::Folder;
use crate::files::kind::{self, Kind};
use crate::source::log::{is_log, is_mapped_table};
use crate::source::log_file::is_standard_input;
use crate::source::read_options::ReadOptions;
use crate::terminal::print::{alert, note};
use std::fs::File;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Logs that can be read again. What can be read only once, standard input or a pipe, is copied to
/// a temporary file.
pub(super) struct LogFiles {
    /// The files, in the order of the logs.
    pub paths: Vec<PathBuf>,
    /// The copies.
    _copies: Vec<TempDir>,
}

impl LogFiles {
    /// Takes the logs of a command. A folder means the logs in it and its subfolders, by name.
    ///
    /// # Errors
    /// Returns an error if standard input or a pipe cannot be copied, and for a folder without logs.
    pub fn of(logs: &[PathBuf], options: &ReadOptions) -> Result<Self> {
        let mut files = Self {
            paths: Vec::with_capacity(logs.len()),
            _copies: Vec::new(),
        };
        for log in logs {
            if log.is_dir() {
                files.paths.extend(logs_below(log, options)?);
                continue;
            }
            if log.is_file() || !is_standard_input(log) && !log.exists() {
                files.paths.push(log.clone());
                continue;
            }
            let folder = tempfile::tempdir().map_err(Error::io(log))?;
            let copy = folder.path().join(name(log));
            copy_of(log, &copy).map_err(Error::io(log))?;
            files.paths.push(copy);
            files._copies.push(folder);
        }
        Ok(files)
    }
}

/// Returns the log that a path means: itself, or the only one in a folder.
///
/// # Errors
/// Returns an error for a folder with no log, or with several.
pub(super) fn one(log: &Path, options: &ReadOptions) -> Result<PathBuf> {
    if !log.is_dir() {
        return Ok(log.to_owned());
    }
    let found = logs_below(log, options)?;
    match &*found {
        [only] => Ok(only.clone()),
        _ => {
            let problem = format!(
                "is a folder of {} logs; expected one log (`roadgrade map` takes them all)",
                found.len()
            );
            Err(Error::content(log, problem))
        }
    }
}

/// Returns the logs in a folder and its subfolders, by name, and the tables that a mapping fits.
fn logs_below(folder: &Path, options: &ReadOptions) -> Result<Vec<PathBuf>> {
    files_below(folder, "log", |path| {
        is_log(path) || is_mapped_table(path, options)
    })
}

/// Returns these files, and those of this kind in the folders among them, by name.
///
/// # Errors
/// Returns an error for a folder without such a file.
pub(super) fn of_kind(paths: &[PathBuf], what: &str, wanted: Kind) -> Result<Vec<PathBuf>> {
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        if path.is_dir() {
            files.extend(files_below(path, what, |path| {
                kind::of(path) == Some(wanted)
            })?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn files_below(
    folder: &Path,
    what: &str,
    is_wanted: impl Fn(&Path) -> bool,
) -> Result<Vec<PathBuf>> {
    let found = Folder::read(folder, is_wanted)?;
    let skipped = [found.hidden(folder), found.others(folder, what)];
    skipped.into_iter().flatten().for_each(note);
    for problem in &found.unreadable {
        alert(format_args!("warning: left out: {problem}"));
    }
    if found.files.is_empty() {
        let problem = format!("no {what} in this folder; expected at least one");
        return Err(Error::content(folder, problem));
    }
    Ok(found.files)
}

fn name(log: &Path) -> PathBuf {
    if is_standard_input(log) {
        return PathBuf::from("stdin");
    }
    log.file_name().unwrap_or_default().into()
}

fn copy_of(log: &Path, copy: &Path) -> std::io::Result<u64> {
    let mut to = File::create(copy)?;
    if is_standard_input(log) {
        std::io::copy(&mut std::io::stdin().lock(), &mut to)
    } else {
        std::io::copy(&mut File::open(log)?, &mut to)
    }
}
