//! Output files that appear whole or not at all. A device or a pipe is written through when the
//! file is complete, and never replaced; a symbolic link stays one. `-` is standard output.

use super::object_storage;
use super::temporary::Temporary;
use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Path that means standard output.
const STDOUT: &str = "-";
/// Longest chain of symbolic links that is followed, as in Linux.
const MOST_LINKS: usize = 40;

/// Returns whether a path means standard output.
#[must_use]
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == STDOUT
}

/// Returns whether a path is written through and never replaced: standard output, a device, a pipe.
#[must_use]
pub fn is_written_through(path: &Path) -> bool {
    let is_special = |found: fs::Metadata| !found.is_file() && !found.is_dir();
    is_stdout(path) || is_descriptor(path) || fs::metadata(path).is_ok_and(is_special)
}

/// Returns whether a path is that of an open file (`/dev/stdout`, `/dev/fd/3`), or a link to one:
/// replacing what it names would not reach who opened it.
fn is_descriptor(path: &Path) -> bool {
    let below = |name: &PathBuf| ["/proc", "/dev/fd"].iter().any(|of| name.starts_with(of));
    links(path).iter().any(below)
}

/// Returns what a path names when symbolic links are followed, whether it exists or not.
fn target_of(path: &Path) -> PathBuf {
    links(path).pop().unwrap_or_else(|| path.to_owned())
}

/// Returns a path and what it names, link by link.
fn links(path: &Path) -> Vec<PathBuf> {
    let follow = |from: &PathBuf| Some(folder_of(from).join(fs::read_link(from).ok()?));
    std::iter::successors(Some(path.to_owned()), follow)
        .take(MOST_LINKS)
        .collect()
}

/// A complete file that has not yet appeared under its name. If dropped, it leaves nothing.
#[derive(Debug)]
#[must_use = "the file appears when it is committed"]
pub struct Staged {
    path: PathBuf,
    /// The path with symbolic links followed.
    target: PathBuf,
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
    /// Moves the file to its path, in place of an earlier file. A file that stands for an object is
    /// sent.
    ///
    /// # Errors
    /// Returns the error of the file system, or of object storage; `path` is then unchanged.
    pub fn commit(self) -> Result<()> {
        let Self {
            path,
            target,
            content,
        } = self;
        match content {
            Content::Beside(file) => {
                file.persist(&target).map_err(Error::io(&path))?;
                object_storage::send(&target)
            }
            Content::Aside(file) => copy_to(&path, file).map_err(Error::io(&path)),
        }
    }

    /// Moves the file to its path as [`commit`](Self::commit) does, forced to the disk, and keeps
    /// the earlier file as `previous` if there is one. At any moment the path has the earlier or
    /// the new file.
    ///
    /// # Errors
    /// Returns the error of the file system; `path` is then unchanged.
    pub fn commit_keeping(self, previous: Option<&Path>) -> Result<()> {
        let Self {
            path,
            target,
            content,
        } = self;
        let Content::Beside(file) = content else {
            return Self {
                path,
                target,
                content,
            }
            .commit();
        };
        file.sync().map_err(Error::io(&path))?;
        if let Some(previous) = previous {
            keep(&target, previous).map_err(Error::io(previous))?;
        }
        file.persist(&target).map_err(Error::io(&path))?;
        // The file has its name; whether the name is on the disk yet is not worth an error.
        let _ = File::open(folder_of(&target)).and_then(|folder| folder.sync_all());
        object_storage::send(&target)
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
    if is_stdout(path) {
        let mut stdout = io::stdout().lock();
        // A reader that has seen enough (`| head`) closes the pipe.
        return match io::copy(&mut content, &mut stdout).and_then(|_| stdout.flush()) {
            Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            written => written,
        };
    }
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
    target: PathBuf,
    file: BufWriter<Content>,
}

impl Writing {
    /// Begins a file for `path`, in a temporary file beside it.
    ///
    /// # Errors
    /// Returns the error of the file system; a folder is one.
    pub fn begin(path: &Path) -> Result<Self> {
        let target = target_of(path);
        if fs::metadata(path).is_ok_and(|found| found.is_dir()) {
            return Err(Error::content(path, "is a folder; expected a file"));
        }
        let content = if is_written_through(path) {
            Content::Aside(tempfile::tempfile().map_err(Error::io(path))?)
        } else {
            let folder = folder_of(&target);
            fs::create_dir_all(folder).map_err(Error::io(folder))?;
            Content::Beside(Temporary::create_in(folder).map_err(Error::io(path))?)
        };
        Ok(Self {
            path: path.to_owned(),
            target,
            file: BufWriter::new(content),
        })
    }

    /// Completes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn finish(self) -> Result<Staged> {
        let Self { path, target, file } = self;
        let content = file
            .into_inner()
            .map_err(|e| Error::io(&path)(e.into_error()))?;
        Ok(Staged {
            path,
            target,
            content,
        })
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
