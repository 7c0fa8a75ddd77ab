//! What a reader of Parquet reads from: a file.

use std::fs::File;
use std::io;

/// What a reader of Parquet reads from.
pub type TableFile = File;

/// Returns an open file as a reader of Parquet takes it.
///
/// # Errors
/// Returns no error.
pub const fn table_file(file: File) -> io::Result<TableFile> {
    Ok(file)
}
