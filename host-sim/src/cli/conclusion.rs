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
    kept_file: Option<&Path>,
) -> Result<()> {
    let keeping = match kept_file.zip(drive.kept.as_ref()) {
        Some((file, kept)) => Some(kept::stage(file, kept)?),
        None => None,
    };
    if let Some(out) = out {
        run::write_rows(out, &mut drive.rows, origin)?;
    }
    let is_kept = keeping.is_some();
    if let Some(keeping) = keeping {
        keeping.commit()?;
    }
    if let Some(out) = out {
        eprintln!("wrote {}", out.display());
    }
    if let Some(file) = kept_file {
        let file = file.display();
        if is_kept {
            eprintln!("kept for the next drive: {file}");
        } else {
            eprintln!("nothing to keep, 5 km with GNSS are needed: {file} is as it was");
        }
    }
    Ok(())
}
