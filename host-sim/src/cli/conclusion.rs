//! Writes the files at the end of a drive, recorded or live.

use crate::error::{Result, on_one_line};
use crate::files::kept;
use crate::files::run::{self, Origin};
use crate::recorder::{LongRun, Warning, replaced};
use crate::terminal::print::{alert, note};
use estimator_core::Model;
use std::path::Path;

/// Prints warnings, each with what to do.
pub(super) fn warn(warnings: &[Warning]) {
    warn_each("", warnings);
}

/// Prints the warnings of one of several drives.
pub(super) fn warn_of(run: &str, warnings: &[Warning]) {
    warn_each(&format!("{run}: "), warnings);
}

fn warn_each(whose: &str, warnings: &[Warning]) {
    for Warning {
        message, advice, ..
    } in warnings
    {
        alert(format_args!("warning: {whose}{message}; {advice}"));
    }
}

/// Says which parameters of the given model the bus contradicted.
pub(super) fn note_replaced(given: &Model, drive: &LongRun) {
    for parameter in replaced(given, &drive.model) {
        note(format_args!("{parameter}"));
    }
}

/// Writes the run, and the persistent state if there is a file for it. The state is staged before
/// the run is written, so that neither file appears if one cannot be written.
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
        note(format_args!("wrote {}", on_one_line(out)));
    }
    if let Some(file) = state_file {
        let file = on_one_line(file);
        if is_stored {
            note(format_args!(
                "stored the persistent state for the next drive: {file}"
            ));
        } else {
            note(format_args!(
                "no persistent state to store (it needs 5 km with GNSS): {file} is unchanged"
            ));
        }
    }
    Ok(())
}
