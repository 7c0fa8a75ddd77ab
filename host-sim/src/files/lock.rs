//! A lock on a file that a program reads and replaces: a second program waits for the first.

use super::signals;
use crate::error::{Error, Result};
use crate::platform::file_number;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The lock of a file, until it is dropped.
///
/// The file itself is replaced, so the lock is on a file beside it, `.NAME.lock`. It is removed with
/// the lock; one that a killed program left is not locked, and serves the next program.
#[derive(Debug)]
pub struct FileLock {
    path: PathBuf,
    _file: File,
}

impl FileLock {
    /// Locks a file. `waiting` is called once if another program has the lock.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn wait(of: &Path, waiting: impl FnOnce()) -> Result<Self> {
        let name = of.file_name().unwrap_or_default().to_string_lossy();
        let path = of.with_file_name(format!(".{name}.lock"));
        let mut waiting = Some(waiting);
        loop {
            let file = OpenOptions::new()
                .create(true)
                .append(true)
                .open(&path)
                .map_err(Error::io(&path))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    if let Some(waiting) = waiting.take() {
                        waiting();
                    }
                    file.lock().map_err(Error::io(&path))?;
                }
                // A file system without locks: as before there were any.
                Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {}
                Err(TryLockError::Error(e)) => return Err(Error::io(&path)(e)),
            }
            // The one before may have removed the file that it had locked.
            let own = file.metadata().map_err(Error::io(&path))?;
            if fs::metadata(&path).is_ok_and(|named| file_number(&named) == file_number(&own)) {
                let own = || Ok(Self { path, _file: file });
                return signals::removed_at_end(own, |lock| &lock.path);
            }
        }
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
        signals::forget(&self.path);
    }
}

/// Returns true if this is the name of a lock.
#[must_use]
pub fn is_lock(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with('.') && name.ends_with(".lock")
}
