//! A whole log through the estimator.

use super::drive_recorder::Recorder;
use super::long_run::LongRun;
use crate::error::{Error, Result};
use crate::source::input::for_each_input;
use estimator_core::{Estimator, Model, PersistentState, PersistentStateError, Scalar, Tuning};
use std::path::Path;

/// Feeds a whole log of either kind to an estimator that begins with what the last drive left, if
/// anything. `progress` is told the bytes read so far, now and then.
///
/// # Errors
/// An impossible vehicle, or not that of the last drive; a log that cannot be read to its end, with
/// file and line.
pub fn estimate_log<S: Scalar>(
    model: &Model,
    kept: Option<&PersistentState>,
    log: &Path,
    progress: impl Fn(u64),
) -> Result<LongRun> {
    let (model, tuning) = (model.clone(), Tuning::default());
    let estimator = match kept {
        Some(kept) => Estimator::<S>::restore(model, tuning, kept),
        None => Estimator::new(model, tuning).map_err(PersistentStateError::from),
    };
    let mut recorder = Recorder::from(estimator.map_err(|e| Error::content(log, e.to_string()))?);
    for_each_input(log, progress, |input| recorder.on_input(&input))?;
    recorder.end()
}
