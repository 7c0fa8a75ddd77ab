//! Temporary files and folders beside outputs: `.roadgrade-XXXXXX.tmp`.
//!
//! Each is locked while it is in use, and removed when it is dropped or when a signal ends the
//! program. A killed program cannot remove its own; they are recognised by their names, are not
//! locked any more, and are removed by the next program that writes into the folder.

use super::signals;
use crate::platform::{file_number, readable_by_all};
use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::{Builder, NamedTempFile, TempDir};

const PREFIX: &str = ".roadgrade-";
const SUFFIX: &str = ".tmp";

/// A temporary file with a name.
#[derive(Debug)]
pub struct Temporary(Option<NamedTempFile>);

impl Temporary {
    /// Creates a file in a folder, and first removes what killed programs left there.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn create_in(folder: &Path) -> io::Result<Self> {
        sweep_once(folder);
        loop {
            let make = || readable_by_all(&mut builder()).tempfile_in(folder);
            let file = signals::removed_at_end(make, NamedTempFile::path)?;
            let made = Self(Some(file));
            if made.is_ours()? {
                return Ok(made);
            }
        }
    }

    /// Locks the file. Returns false if another program took it for a leftover before that.
    fn is_ours(&self) -> io::Result<bool> {
        let Some(file) = &self.0 else {
            return Ok(false);
        };
        match file.as_file().try_lock() {
            // A file system without locks: nobody removes what cannot be locked.
            Ok(()) | Err(TryLockError::Error(_)) => {}
            Err(TryLockError::WouldBlock) => return Ok(false),
        }
        let own = file.as_file().metadata()?;
        Ok(fs::metadata(file.path()).is_ok_and(|named| file_number(&named) == file_number(&own)))
    }

    /// Returns its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.as_ref().map_or(Path::new(""), NamedTempFile::path)
    }

    /// Forces its content to the disk.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn sync(&self) -> io::Result<()> {
        self.0
            .as_ref()
            .map_or(Ok(()), |file| file.as_file().sync_all())
    }

    /// Gives the file its name, in place of an earlier file.
    ///
    /// # Errors
    /// Returns the error of the file system; `path` is then unchanged.
    pub fn persist(mut self, path: &Path) -> io::Result<()> {
        let Some(file) = self.0.take() else {
            return Ok(());
        };
        let temporary = file.path().to_owned();
        let persisted = file.persist(path).map_err(|e| e.error);
        signals::forget(&temporary);
        persisted.map(drop)
    }
}

impl Write for Temporary {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.as_mut().map_or(Ok(0), |file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.as_mut().map_or(Ok(()), NamedTempFile::flush)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(file) = self.0.take() {
            let path = file.path().to_owned();
            drop(file);
            signals::forget(&path);
        }
    }
}

/// A temporary folder.
#[derive(Debug)]
pub struct TemporaryFolder {
    folder: Option<TempDir>,
    /// Holds the lock.
    _handle: Option<File>,
}

impl TemporaryFolder {
    /// Creates a folder in a folder.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn create_in(folder: &Path) -> io::Result<Self> {
        sweep_once(folder);
        let make = || builder().tempdir_in(folder);
        let made = signals::removed_at_end(make, TempDir::path)?;
        let handle = File::open(made.path()).ok();
        if let Some(handle) = &handle {
            let _ = handle.try_lock();
        }
        Ok(Self {
            folder: Some(made),
            _handle: handle,
        })
    }

    /// Returns its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.as_ref().map_or(Path::new(""), TempDir::path)
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        if let Some(folder) = self.folder.take() {
            let path = folder.path().to_owned();
            drop(folder);
            signals::forget(&path);
        }
    }
}

fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    builder
}

/// Returns true if this is the name of a temporary file.
#[must_use]
pub fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with(PREFIX) && name.ends_with(SUFFIX)
}

/// Removes leftovers, once for each folder: a folder may have many files.
fn sweep_once(folder: &Path) {
    static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut swept = SWEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if !swept.insert(folder.to_owned()) {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        // What is in use is locked; what cannot be locked or removed stays.
        if is_temporary(&path)
            && let Ok(kind) = entry.file_type()
            && (kind.is_file() || kind.is_dir())
            && let Ok(file) = File::open(&path)
            && file.try_lock().is_ok()
        {
            let _ = if kind.is_dir() {
                fs::remove_dir_all(&path)
            } else {
                fs::remove_file(&path)
            };
        }
    }
}

/// Makes something under a temporary name in a folder.
///
/// # Errors
/// Returns the error of `make`.
pub(super) fn name_in(
    folder: &Path,
    make: impl FnMut(&Path) -> io::Result<()>,
) -> io::Result<NamedTempFile<()>> {
    builder().make_in(folder, make)
}
