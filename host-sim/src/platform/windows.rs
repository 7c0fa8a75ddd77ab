//! Windows.

use std::fs::{File, Metadata};
use std::io;
use tempfile::Builder;

/// Code of the error for a folder where a file is expected: `ERROR_ACCESS_DENIED`, which files that
/// may not be read have too.
pub const IS_FOLDER: i32 = 5;
/// Codes of the errors for too many open files: `ERROR_TOO_MANY_OPEN_FILES`, and that of the C
/// library.
pub const OUT_OF_FILES: [i32; 2] = [4, 24];

/// What a reader of Parquet reads from.
pub type TableFile = File;

/// Returns an open file as a reader of Parquet takes it.
///
/// # Errors
/// Returns no error.
pub const fn table_file(file: File) -> io::Result<TableFile> {
    Ok(file)
}

/// Returns `None`: the standard library has no stable number of a file.
#[must_use]
pub const fn file_number(_of: &Metadata) -> Option<u64> {
    None
}

/// Changes nothing: a temporary file has the permissions of its folder.
pub const fn readable_by_all<'a, 'p, 's>(
    builder: &'a mut Builder<'p, 's>,
) -> &'a mut Builder<'p, 's> {
    builder
}
