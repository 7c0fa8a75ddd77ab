//! Output files that appear whole or not at all.

use crate::error::{Error, Result};
use std::fs::{self, Permissions};
use std::io::{self, BufWriter, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A complete file that has not yet appeared under its name. If dropped, it leaves nothing.
#[derive(Debug)]
#[must_use = "the file appears when it is committed"]
pub struct Staged {
    path: PathBuf,
    file: NamedTempFile,
}

impl Staged {
    /// Moves the file to its path, in place of an earlier file.
    ///
    /// # Errors
    /// Returns the error of the file system; `path` is then unchanged.
    pub fn commit(self) -> Result<()> {
        let Self { path, file } = self;
        file.persist(&path).map_err(|e| Error::io(&path)(e.error))?;
        Ok(())
    }
}

/// A file that is written piece by piece. If dropped, it leaves nothing.
#[derive(Debug)]
pub struct Writing {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

impl Writing {
    /// Begins a file for `path`, in a temporary file beside it.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn begin(path: &Path) -> Result<Self> {
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        fs::create_dir_all(folder).map_err(Error::io(folder))?;
        // Readable as any other new file; temporary files are private to their owner.
        let file = tempfile::Builder::new()
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(folder)
            .map_err(Error::io(path))?;
        Ok(Self {
            path: path.to_owned(),
            file: BufWriter::new(file),
        })
    }

    /// Completes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn finish(self) -> Result<Staged> {
        let Self { path, file } = self;
        let file = file
            .into_inner()
            .map_err(|e| Error::io(&path)(e.into_error()))?;
        Ok(Staged { path, file })
    }
}

impl Write for Writing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Writes `path` through `content`: into a temporary file beside it, which is renamed when
/// complete.
///
/// # Errors
/// Returns the error of `content` or of the file system; `path` is then unchanged.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    stage(path, content)?.commit()
}

/// Writes a file as [`write_whole`] does, but it appears only when it is committed. Several files
/// can so appear together or not at all.
///
/// # Errors
/// Returns the error of `content` or of the file system.
pub fn stage(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Staged> {
    let mut writing = Writing::begin(path)?;
    content(&mut writing).map_err(Error::io(path))?;
    writing.finish()
}

/// Stages a text file; see [`stage`].
///
/// # Errors
/// Returns the error of the file system.
pub fn stage_text(path: &Path, text: &str) -> Result<Staged> {
    stage(path, |out| out.write_all(text.as_bytes()))
}
