//! A log through the estimator.

use estimator_core::{Model, Tuning};
use host_sim::error::{Error, Result};
use host_sim::files::run::RunRow;
use host_sim::recorder::Recorder;
use host_sim::source::input::for_each_input;
use host_sim::source::read_options::ReadOptions;
use std::path::Path;

/// Estimates a log, as `estimate` does.
///
/// # Errors
/// Returns an error for a vehicle or a log that `estimate` refuses.
pub fn run(
    log: &Path,
    model: &Model,
    tuning: &Tuning,
    options: &ReadOptions,
) -> Result<Vec<RunRow>> {
    let mut recorder = Recorder::<f32>::new(model.clone(), tuning.clone())
        .map_err(|error| Error::content(log, error.to_string()))?;
    recorder.read_as(options);
    for_each_input(log, options, |_| (), |input| recorder.on_input(&input))?;
    Ok(recorder.finish()?.rows)
}
