//! Unix.

use nix::errno::Errno;
use std::fs::{File, Metadata, Permissions};
use std::io;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use tempfile::Builder;

/// Code of the error for a folder where a file is expected.
pub const IS_FOLDER: i32 = Errno::EISDIR as i32;
/// Codes of the errors for too many open files, of the process and of the machine.
pub const OUT_OF_FILES: [i32; 2] = [Errno::EMFILE as i32, Errno::ENFILE as i32];

/// What a reader of Parquet reads from.
pub type TableFile = File;

/// Returns an open file as a reader of Parquet takes it.
///
/// # Errors
/// Returns no error.
pub const fn table_file(file: File) -> io::Result<TableFile> {
    Ok(file)
}

/// Returns what identifies a file on its disk, whatever its name; `None` where nothing does.
#[must_use]
pub fn file_number(of: &Metadata) -> Option<u64> {
    Some(of.ino())
}

/// Makes temporary files readable as any other new file. They are private to their owner otherwise.
pub fn readable_by_all<'a, 'p, 's>(builder: &'a mut Builder<'p, 's>) -> &'a mut Builder<'p, 's> {
    builder.permissions(Permissions::from_mode(0o666))
}
