//! Output files that appear whole or not at all. A device or a pipe is written through when the
//! file is complete, and never replaced.

use super::temporary::Temporary;
use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A complete file that has not yet appeared under its name. If dropped, it leaves nothing.
#[derive(Debug)]
#[must_use = "the file appears when it is committed"]
pub struct Staged {
    path: PathBuf,
    content: Content,
}

/// Where the content waits.
#[derive(Debug)]
enum Content {
    /// In a file beside the path, which is renamed.
    Beside(Temporary),
    /// In a file without a name, which is copied to a device or a pipe.
    Aside(File),
}

impl Staged {
    /// Moves the file to its path, in place of an earlier file.
    ///
    /// # Errors
    /// Returns the error of the file system; `path` is then unchanged.
    pub fn commit(self) -> Result<()> {
        let Self { path, content } = self;
        match content {
            Content::Beside(file) => file.persist(&path),
            Content::Aside(file) => copy_to(&path, file),
        }
        .map_err(Error::io(&path))
    }

    /// Moves the file to its path as [`commit`](Self::commit) does, forced to the disk, and keeps
    /// the earlier file as `previous` if there is one. At any moment the path has the earlier or
    /// the new file.
    ///
    /// # Errors
    /// Returns the error of the file system; `path` is then unchanged.
    pub fn commit_keeping(self, previous: Option<&Path>) -> Result<()> {
        let Self { path, content } = self;
        let Content::Beside(file) = content else {
            return Self { path, content }.commit();
        };
        file.sync().map_err(Error::io(&path))?;
        if let Some(previous) = previous {
            keep(&path, previous).map_err(Error::io(previous))?;
        }
        file.persist(&path).map_err(Error::io(&path))?;
        // The file has its name; whether the name is on the disk yet is not worth an error.
        let _ = File::open(folder_of(&path)).and_then(|folder| folder.sync_all());
        Ok(())
    }
}

/// Gives a file a second name, in place of an earlier file of that name.
fn keep(path: &Path, previous: &Path) -> io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    let link = |second: &Path| {
        // Not every file system has links.
        fs::hard_link(path, second).or_else(|_| fs::copy(path, second).map(drop))
    };
    let mut attempts = 0..3;
    loop {
        let second: NamedTempFile<()> = super::temporary::name_in(folder_of(path), link)?;
        match second.persist(previous) {
            // Another program took the second name for a leftover and removed it.
            Err(e) if e.error.kind() == io::ErrorKind::NotFound && attempts.next().is_some() => {}
            persisted => return persisted.map(drop).map_err(|e| e.error),
        }
    }
}

fn copy_to(path: &Path, mut content: File) -> io::Result<()> {
    content.rewind()?;
    let mut device = OpenOptions::new().write(true).open(path)?;
    io::copy(&mut content, &mut device)?;
    device.flush()
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A file that is written piece by piece. If dropped, it leaves nothing.
#[derive(Debug)]
pub struct Writing {
    path: PathBuf,
    file: BufWriter<Content>,
}

impl Writing {
    /// Begins a file for `path`, in a temporary file beside it.
    ///
    /// # Errors
    /// Returns the error of the file system; a folder is one.
    pub fn begin(path: &Path) -> Result<Self> {
        let folder = folder_of(path);
        let content = match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                return Err(Error::content(path, "is a folder; expected a file"));
            }
            Ok(found) if !found.is_file() => {
                Content::Aside(tempfile::tempfile().map_err(Error::io(path))?)
            }
            _ => {
                fs::create_dir_all(folder).map_err(Error::io(folder))?;
                Content::Beside(Temporary::create_in(folder).map_err(Error::io(path))?)
            }
        };
        Ok(Self {
            path: path.to_owned(),
            file: BufWriter::new(content),
        })
    }

    /// Completes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn finish(self) -> Result<Staged> {
        let Self { path, file } = self;
        let content = file
            .into_inner()
            .map_err(|e| Error::io(&path)(e.into_error()))?;
        Ok(Staged { path, content })
    }
}

impl Write for Content {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Beside(file) => file.write(bytes),
            Self::Aside(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Beside(file) => file.flush(),
            Self::Aside(file) => file.flush(),
        }
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
