//! The end of a drive, recorded or live: its files.

use crate::error::Result;
use crate::files::kept;
use crate::files::run::{self, Origin};
use crate::recorder::LongRun;
use std::path::Path;

/// Writes what a drive leaves: the run, and what is kept for the next one if there is a file for
/// it, which is written ahead of the run: where that cannot be, neither appears.
pub(super) fn write(
    drive: &mut LongRun,
    out: Option<&Path>,
    origin: &Origin,
    state_file: Option<&Path>,
) -> Result<()> {
    let staged = match state_file.zip(drive.persistent_state.as_ref()) {
        Some((file, state)) => Some(kept::stage(file, state)?),
        None => None,
    };
    if let Some(out) = out {
        run::write_rows(out, &mut drive.rows, origin)?;
    }
    let is_stored = staged.is_some();
    if let Some(staged) = staged {
        staged.commit()?;
    }
    if let Some(out) = out {
        eprintln!("wrote {}", out.display());
    }
    if let Some(file) = state_file {
        let file = file.display();
        if is_stored {
            eprintln!("kept for the next drive: {file}");
        } else {
            eprintln!("nothing to keep, 5 km with GNSS are needed: {file} is as it was");
        }
    }
    Ok(())
}
