//! What tells whether two names are of one file.

use same_file::Handle;
use std::path::Path;

/// Returns what identifies a file, through links; `None` for a file that is not there, and for a
/// device or a pipe: it is never overwritten, and opening a pipe waits for its other end.
pub(crate) fn handle(path: &Path) -> Option<Handle> {
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    is_file.then(|| Handle::from_path(path).ok()).flatten()
}
