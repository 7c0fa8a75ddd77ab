//! Outputs that must not be inputs.

use crate::error::{Error, Result, on_one_line};
use same_file::Handle;
use std::path::{Path, PathBuf};

/// Checks, before anything is written, that no output is an input or another output, under
/// whatever name.
///
/// # Errors
/// Names both files.
pub(super) fn check<'p>(
    inputs: impl IntoIterator<Item = &'p Path>,
    outputs: impl IntoIterator<Item = &'p Path>,
) -> Result<()> {
    let mut known: Vec<(PathBuf, Option<Handle>, &str)> = inputs
        .into_iter()
        .map(|path| (path.to_owned(), handle(path), "an input"))
        .collect();
    for path in outputs {
        let own = handle(path);
        let same = known.iter().find(|(other, handle, _)| {
            other == path || (own.is_some() && own.as_ref() == handle.as_ref())
        });
        if let Some((other, _, what)) = same {
            let name = if other == path {
                String::new()
            } else {
                format!(" ({})", on_one_line(other))
            };
            let problem = format!("is {what} too{name}; expected another file for the output");
            return Err(Error::content(path, problem));
        }
        known.push((path.to_owned(), own, "another output"));
    }
    Ok(())
}

/// Returns what identifies a file, through links; `None` for a file that is not there. A device or
/// a pipe is never overwritten.
fn handle(path: &Path) -> Option<Handle> {
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    is_file.then(|| Handle::from_path(path).ok()).flatten()
}
