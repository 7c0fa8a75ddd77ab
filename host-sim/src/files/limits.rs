//! Limits of what is read, so that no input takes all memory.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Bytes of the rows of a table, or of the steps of a simulated drive, that are in memory as a
/// whole. What is streamed has no such limit.
const MEMORY_BYTES: u64 = 4 << 30;
/// Rows of a road.
pub const ROAD_ROWS: usize = 2_000_000;
/// Rows of a map, all ways of a network together.
pub const MAP_ROWS: usize = 6_000_000;
/// Rows for which memory is taken at first.
const FIRST_ROWS: usize = 64;
/// Bytes of a record of a table, quoted line breaks included.
pub const RECORD_BYTES: usize = 1 << 20;
/// Bytes of a text that is read as a whole: vehicle, tuning and scenario files.
const TEXT_BYTES: u64 = 1 << 20;

/// Returns how many rows of this type may be in memory.
#[must_use]
pub const fn rows_in_memory<T>() -> usize {
    (MEMORY_BYTES / size_of::<T>() as u64) as usize
}

/// Appends a row to those of a file that are in memory; `most` as [`rows_in_memory`] gives it, or
/// fewer.
///
/// # Errors
/// Returns an error if there are as many already, or if no memory is left.
pub(crate) fn push<T>(rows: &mut Vec<T>, row: T, most: usize, path: &Path) -> Result<()> {
    if rows.len() >= most {
        return Err(too_many_rows(path, most));
    }
    if rows.len() == rows.capacity() {
        let more = rows.len().max(FIRST_ROWS).min(most - rows.len());
        rows.try_reserve_exact(more).map_err(|_| {
            let problem = format!("more than {} rows, and no memory for them", rows.len());
            Error::io(path)(io::Error::new(ErrorKind::OutOfMemory, problem))
        })?;
    }
    rows.push(row);
    Ok(())
}

/// Reads a text file.
///
/// # Errors
/// Returns the error of the file system, or an error for a file of more than 1 MiB.
pub fn read_text(path: &Path) -> Result<String> {
    let mut text = String::new();
    let file = File::open(path).map_err(Error::io(path))?;
    let count = file.take(TEXT_BYTES + 1).read_to_string(&mut text);
    // A character may be cut at the limit, so the length is checked first.
    match count {
        Ok(count) if count as u64 <= TEXT_BYTES => Ok(text),
        Err(e) if !is_longer(path) => Err(Error::io(path)(e)),
        _ => Err(too_long(path, TEXT_BYTES)),
    }
}

/// Reads a file of at most `most` bytes.
///
/// # Errors
/// Returns the error of the file system, or an error for a longer file.
pub fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(Error::io(path))?;
    let count = file.take(most + 1).read_to_end(&mut bytes);
    if count.map_err(Error::io(path))? as u64 > most {
        return Err(too_long(path, most));
    }
    Ok(bytes)
}

fn is_longer(path: &Path) -> bool {
    path.metadata().is_ok_and(|file| file.len() > TEXT_BYTES)
}

fn too_long(path: &Path, most: u64) -> Error {
    Error::content(
        path,
        format!("more than {most} bytes; expected a file of this kind, which is far smaller"),
    )
}

/// Returns the error of a table with more than `most` rows.
pub(crate) fn too_many_rows(path: &Path, most: usize) -> Error {
    Error::content(
        path,
        format!("more than {most} rows; expected at most {most}"),
    )
}

/// A reader that ends with an error after a number of bytes, unless the budget is renewed.
#[derive(Debug)]
pub struct Budget<R> {
    inner: R,
    left: usize,
    most: usize,
    what: &'static str,
}

impl<R> Budget<R> {
    /// Limits the bytes of a `what`, such as a record.
    pub const fn new(inner: R, most: usize, what: &'static str) -> Self {
        Self {
            inner,
            left: most,
            most,
            what,
        }
    }

    /// Begins the next `what`.
    pub const fn renew(&mut self) {
        self.left = self.most;
    }

    /// Returns the reader that is limited.
    pub const fn inner(&self) -> &R {
        &self.inner
    }
}

impl<R: Read> Read for Budget<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 && !buffer.is_empty() {
            let problem = format!(
                "a {} of more than {} bytes; expected a shorter one",
                self.what, self.most
            );
            return Err(io::Error::new(ErrorKind::FileTooLarge, problem));
        }
        let most = buffer.len().min(self.left);
        let count = self.inner.read(&mut buffer[..most])?;
        self.left -= count;
        Ok(count)
    }
}

/// Returns true if the error is that of a [`Budget`].
#[must_use]
pub fn is_over_budget(error: &io::Error) -> bool {
    error.kind() == ErrorKind::FileTooLarge && error.raw_os_error().is_none()
}
