//! What a reader of Parquet reads from: the file in memory. It wants a second handle of an open file,
//! which WASI does not give.

use bytes::Bytes;
use std::fs::File;
use std::io::{self, Read};

/// What a reader of Parquet reads from.
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
