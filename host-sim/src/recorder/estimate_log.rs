//! Estimation of a whole log.

use super::drive_recorder::Recorder;
use super::long_run::LongRun;
use crate::error::{Error, Result};
use crate::source::input::for_each_input;
use crate::source::read_options::ReadOptions;
use estimator_core::{Model, PersistentState, Scalar, Tuning};
use std::path::Path;

/// Passes a whole log of either kind to an estimator that starts from the persistent state of the
/// last drive, if any. `progress` gets the bytes read so far.
///
/// # Errors
/// Returns an error for invalid parameters, for the state of another vehicle, and, with file and
/// line, for a log that cannot be read to its end.
pub fn estimate_log<S: Scalar>(
    model: &Model,
    tuning: &Tuning,
    persistent_state: Option<&PersistentState>,
    log: &Path,
    options: &ReadOptions,
    progress: impl Fn(u64),
) -> Result<LongRun> {
    let mut recorder = Recorder::<S>::resume(model, tuning, persistent_state)
        .map_err(|e| Error::content(log, e.to_string()))?;
    recorder.ignore(&options.ignore);
    let report = for_each_input(log, options, progress, |input| recorder.on_input(&input))?;
    let mut run = recorder.end()?;
    run.log = report;
    Ok(run)
}
