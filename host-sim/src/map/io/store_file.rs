//! The file of a store: locked while it is changed, replaced at once, and the version before kept.

use super::store::{self, MapStore};
use crate::error::{Error, Result, on_one_line};
use crate::files::lock::FileLock;
use crate::files::output::Staged;
use crate::terminal::print::note;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Ending of the version before.
const PREVIOUS: &str = ".previous";

/// A store that this program reads and may replace.
#[derive(Debug)]
pub(crate) struct StoreFile {
    path: PathBuf,
    /// Held while the store may change; `None` if it is only read.
    lock: Option<FileLock>,
    /// True if the version before this program is kept already.
    is_kept: bool,
}

impl StoreFile {
    /// Opens the store to add to it, and waits while another program does.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub(crate) fn lock(path: &Path) -> Result<Self> {
        let path = resolved(path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(Error::io(folder))?;
        }
        let waiting = || {
            let name = on_one_line(&path);
            note(format_args!("{name}: waits for another fusion to end"));
        };
        let lock = FileLock::wait(&path, waiting)?;
        Ok(Self {
            path,
            lock: Some(lock),
            is_kept: false,
        })
    }

    /// Opens the store to read it.
    pub(crate) fn of(path: &Path) -> Self {
        Self {
            path: resolved(path),
            lock: None,
            is_kept: false,
        }
    }

    /// Returns its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the store.
    ///
    /// # Errors
    /// Names the file, the line and what was expected, and what to do.
    pub(crate) fn read(&self) -> Result<MapStore> {
        let store = store::read(&self.path).map_err(|error| self.advised(error))?;
        if !store.has_checksum {
            let path = on_one_line(&self.path);
            note(format_args!(
                "{path}: written without a checksum, by an earlier release; it gets one with the next run"
            ));
        }
        Ok(store)
    }

    /// Replaces the store. The first time, the version before is kept.
    ///
    /// # Errors
    /// Returns the error of the file system; the store is then unchanged.
    pub(crate) fn replace(&mut self, staged: Staged) -> Result<()> {
        debug_assert!(
            self.lock.is_some(),
            "a store is locked before it is changed"
        );
        let previous = self.previous();
        staged.commit_keeping((!self.is_kept).then_some(&*previous))?;
        self.is_kept = true;
        Ok(())
    }

    /// Returns the path of the version before.
    fn previous(&self) -> PathBuf {
        let mut name = OsString::from(&self.path);
        name.push(PREVIOUS);
        name.into()
    }

    /// Adds to an error of the content what to do about it.
    fn advised(&self, error: Error) -> Error {
        let previous = self.previous();
        if matches!(error, Error::Io { .. }) || !previous.exists() {
            return error;
        }
        let advice = format!(
            "; {} is the version before: copy it over this file, and add the later runs again",
            on_one_line(&previous)
        );
        match error {
            Error::Line {
                path,
                line,
                problem,
                expected,
            } => Error::Line {
                path,
                line,
                problem,
                expected: expected + &advice,
            },
            Error::Content { path, problem } => Error::Content {
                path,
                problem: problem + &advice,
            },
            other => other,
        }
    }
}

/// Returns the file behind a link, so that all programs lock and replace the same file.
fn resolved(path: &Path) -> PathBuf {
    let is_link = path.is_symlink();
    let target = is_link.then(|| path.canonicalize().ok()).flatten();
    target.unwrap_or_else(|| path.to_owned())
}
