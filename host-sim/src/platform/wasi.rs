//! WebAssembly with a system interface: one user, one program, no numbers of files.

use bytes::Bytes;
use std::fs::{File, Metadata};
use std::io::{self, Read};
use tempfile::Builder;

/// Code of the error for a folder where a file is expected (`errno` of WASI preview 1).
pub const IS_FOLDER: i32 = 31;
/// Codes of the errors for too many open files, of the process and of the machine.
pub const OUT_OF_FILES: [i32; 2] = [33, 41];

/// What a reader of Parquet reads from: the file in memory. A second handle of an open file, which it
/// wants of a file, cannot be had.
pub type TableFile = Bytes;

/// Returns an open file as a reader of Parquet takes it.
///
/// # Errors
/// Returns the error of the read.
pub fn table_file(mut file: File) -> io::Result<TableFile> {
    let mut content = Vec::new();
    file.read_to_end(&mut content)?;
    Ok(content.into())
}

/// Returns `None`: nothing but its name identifies a file.
#[must_use]
pub const fn file_number(_of: &Metadata) -> Option<u64> {
    None
}

/// Changes nothing: files have no permissions.
pub const fn readable_by_all<'a, 'p, 's>(
    builder: &'a mut Builder<'p, 's>,
) -> &'a mut Builder<'p, 's> {
    builder
}
