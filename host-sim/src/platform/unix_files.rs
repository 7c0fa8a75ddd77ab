//! Numbers and permissions of files on Unix.

use std::fs::{Metadata, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use tempfile::Builder;

/// Returns what identifies a file on its disk, whatever its name; `None` where nothing does.
#[must_use]
pub fn file_number(of: &Metadata) -> Option<u64> {
    Some(of.ino())
}

/// Makes temporary files readable as any other new file. They are private to their owner otherwise.
pub fn readable_by_all<'a, 'p, 's>(builder: &'a mut Builder<'p, 's>) -> &'a mut Builder<'p, 's> {
    builder.permissions(Permissions::from_mode(0o666))
}
