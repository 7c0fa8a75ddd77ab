//! Output files appear whole or not at all.

use crate::error::{Error, Result};
use std::fs::{self, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Writes `path` through `content`: into a temporary file beside it, renamed when complete.
///
/// # Errors
/// Whatever `content` says, or the file system; `path` is then as it was before.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder).map_err(Error::io(folder))?;
    // Readable as any other new file; a temporary file is its owner's alone.
    let file = tempfile::Builder::new()
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(folder)
        .map_err(Error::io(path))?;
    let mut writer = BufWriter::new(file);
    content(&mut writer).map_err(Error::io(path))?;
    let file = writer
        .into_inner()
        .map_err(|e| Error::io(path)(e.into_error()))?;
    file.persist(path).map_err(|e| Error::io(path)(e.error))?;
    Ok(())
}

/// Prints to stdout. A reader that has seen enough (`| head`) is no error.
///
/// # Errors
/// If stdout cannot be written.
pub fn print(text: &str) -> Result<()> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("stdout"))(e)),
        _ => Ok(()),
    }
}
