//! Logs that a command reads more than once.

use crate::error::{Error, Result};
use crate::source::log_file::is_standard_input;
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
    /// Takes the logs of a command.
    ///
    /// # Errors
    /// Returns an error if standard input or a pipe cannot be copied.
    pub fn of(logs: &[PathBuf]) -> Result<Self> {
        let mut files = Self {
            paths: Vec::with_capacity(logs.len()),
            _copies: Vec::new(),
        };
        for log in logs {
            if log.is_file() || log.is_dir() || !is_standard_input(log) && !log.exists() {
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
