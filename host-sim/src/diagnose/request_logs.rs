//! The logs of a diagnosis: which are fitted, which are held out, and what they must be.

use super::drive::LoggedDrive;
use super::findings::Request;
use crate::error::{Error, Result, on_one_line};
use crate::files::run::{RunCell, RunIdentity};
use crate::source::read_options::ReadOptions;
use estimator_core::{Model, Signal, Tuning};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

/// The logs of a request. Those to fit are first.
pub(super) struct RequestLogs {
    pub(super) paths: Vec<PathBuf>,
    pub(super) fitted: usize,
    /// Indices of the logs on which before and after are judged.
    pub(super) judged: Range<usize>,
    tuning: Tuning,
    options: ReadOptions,
    accelerometer: bool,
}

impl RequestLogs {
    pub(super) fn of(request: &Request) -> Result<Self> {
        let mut paths = request.logs.clone();
        let held_out = match request.held_out.len() {
            0 => usize::from(paths.len() >= 3),
            given => given,
        };
        paths.extend_from_slice(&request.held_out);
        let mut seen = BTreeSet::new();
        if let Some(twice) = paths.iter().find(|path| !seen.insert(*path)) {
            return Err(Error::content(
                twice,
                "given twice; expected each drive once, to fit or held out".to_owned(),
            ));
        }
        let fitted = paths.len() - held_out;
        let judged = if held_out > 0 { fitted } else { 0 }..paths.len();
        Ok(Self {
            paths,
            fitted,
            judged,
            tuning: request.tuning.clone(),
            options: request.options.clone(),
            accelerometer: request.accelerometer,
        })
    }

    /// Returns an error if two logs have the same drive: a copy that is held out would confirm what
    /// was fitted to it. Cells are compared, so another name, format or compression does not matter.
    pub(super) fn check_copies(&self, drives: &[LoggedDrive]) -> Result<()> {
        let mut seen = BTreeMap::new();
        for (path, drive) in self.paths.iter().zip(drives) {
            let identity = RunIdentity::of(drive.run.rows.iter().map(RunCell::from));
            if let Some(first) = seen.insert(identity, path) {
                let first = on_one_line(first);
                let problem = format!(
                    "the same drive as {first}; expected each drive once, to fit or held out"
                );
                return Err(Error::content(path, problem));
            }
        }
        Ok(())
    }

    /// Returns an error if the accelerometer is asked for and no drive has one.
    pub(super) fn check_accelerometer(&self, drives: &[LoggedDrive]) -> Result<()> {
        let has_one = |drive: &LoggedDrive| drive.accelerometer.is_some();
        if !self.accelerometer || drives[..self.fitted].iter().any(has_one) {
            return Ok(());
        }
        let problem = format!(
            "no {} in it, nor in other drives to fit; expected a log of an accelerometer",
            Signal::LongitudinalAcceleration.column()
        );
        Err(Error::content(&self.paths[0], problem))
    }

    pub(super) fn read(&self, model: &Model) -> Result<Vec<LoggedDrive>> {
        self.read_each(&self.paths, model)
    }

    pub(super) fn read_judged(&self, model: &Model) -> Result<Vec<LoggedDrive>> {
        self.read_each(&self.paths[self.judged.clone()], model)
    }

    fn read_each(&self, paths: &[PathBuf], model: &Model) -> Result<Vec<LoggedDrive>> {
        let read = |path: &PathBuf| {
            let (tuning, options) = (&self.tuning, &self.options);
            if self.accelerometer {
                LoggedDrive::read_with_accelerometer(path, model, tuning, options)
            } else {
                LoggedDrive::read(path, model, tuning, options)
            }
        };
        paths.par_iter().map(read).collect()
    }
}
