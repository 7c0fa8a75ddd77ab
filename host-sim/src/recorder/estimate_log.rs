//! Estimation of a whole log.

use super::drive_recorder::Recorder;
use super::long_run::LongRun;
use crate::error::{Error, Result};
use crate::source::input::for_each_input;
use crate::source::log_report::LogReport;
use crate::source::read_options::ReadOptions;
use estimator_core::{Duration, Instant, Model, PersistentState, Scalar, Tuning};
use std::path::{Path, PathBuf};

/// Time between two parts of a drive whose clocks begin anew.
const BETWEEN_PARTS: Duration = Duration::from_micros(1_000_000);

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
    let recorder = Recorder::<S>::resume(model, tuning, persistent_state)
        .map_err(|e| Error::content(log, e.to_string()))?;
    record_log(recorder, log, options, progress)
}

/// Passes a whole log to a recorder, and ends the drive.
///
/// # Errors
/// Returns an error, with file and line, for a log that cannot be read to its end.
pub fn record_log<S: Scalar>(
    mut recorder: Recorder<S>,
    log: &Path,
    options: &ReadOptions,
    progress: impl Fn(u64),
) -> Result<LongRun> {
    recorder.read_as(options);
    let report = for_each_input(log, options, progress, |input| recorder.on_input(&input))?;
    let mut run = recorder.end()?;
    run.start_utc = report.start_utc.clone().or(run.start_utc);
    run.log = report;
    Ok(run)
}

/// Passes logs that are consecutive parts of one drive to an estimator. A log whose clock begins
/// anew continues one second after the end of the one before. Returns the run, and what the reading
/// of each log told.
///
/// # Errors
/// Returns the errors of [`estimate_log`].
pub fn estimate_logs<S: Scalar>(
    model: &Model,
    tuning: &Tuning,
    logs: &[PathBuf],
    options: &ReadOptions,
) -> Result<(LongRun, Vec<(PathBuf, LogReport)>)> {
    let first = logs.first().map_or(Path::new(""), PathBuf::as_path);
    let recorder = Recorder::<S>::resume(model, tuning, None)
        .map_err(|e| Error::content(first, e.to_string()))?;
    record_logs(recorder, logs, options)
}

/// Passes logs that are consecutive parts of one drive to a recorder, and ends the drive.
///
/// # Errors
/// Returns the errors of [`record_log`].
pub fn record_logs<S: Scalar>(
    mut recorder: Recorder<S>,
    logs: &[PathBuf],
    options: &ReadOptions,
) -> Result<(LongRun, Vec<(PathBuf, LogReport)>)> {
    recorder.read_as(options);
    let mut reports = Vec::new();
    let mut end = Instant::default();
    for log in logs {
        let mut shift = None;
        let report = for_each_input(
            log,
            options,
            |_| (),
            |input| {
                let time = input.time();
                let shift = *shift.get_or_insert(if time < end {
                    (end + BETWEEN_PARTS).since(time)
                } else {
                    Duration::default()
                });
                let input = input.at(time + shift);
                end = end.max(input.time());
                recorder.on_input(&input);
            },
        )?;
        reports.push((log.clone(), report));
    }
    let mut run = recorder.end()?;
    let first_start = reports
        .first()
        .and_then(|(_, report)| report.start_utc.clone());
    run.start_utc = first_start.or(run.start_utc);
    Ok((run, reports))
}
