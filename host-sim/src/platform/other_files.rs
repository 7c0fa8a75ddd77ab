//! Numbers and permissions of files where there are none, or none that are stable: Windows and WASI.

use std::fs::Metadata;
use tempfile::Builder;

/// Returns `None`: nothing but its name identifies a file.
#[must_use]
pub const fn file_number(_of: &Metadata) -> Option<u64> {
    None
}

/// Changes nothing: a temporary file is as readable as its folder.
pub const fn readable_by_all<'a, 'p, 's>(
    builder: &'a mut Builder<'p, 's>,
) -> &'a mut Builder<'p, 's> {
    builder
}
