//! The companion files of a run: log, vehicle, oracle, beside its truth. They are named on
//! the command line, or found beside the truth by their names.

use super::rivals::{self, Rival};
use crate::error::Result;
use crate::files::oracle::{OracleFile, mean_speed_mps};
use crate::files::run::RunRow;
use crate::files::vehicle::VehicleFile;
use crate::source::log_kind::kind_of;
use std::path::{Path, PathBuf};

/// Placeholder for the drive's name in names of files.
const NAME: &str = "NAME";
/// Ending of the truth of a simulated drive, after the drive's name.
const TRUTH: &str = ".truth.csv";

/// Files named on the command line: one for all runs, or one for each run.
#[derive(Clone, Copy, Debug, Default)]
pub struct NamedFiles<'a> {
    /// Logs of the runs.
    pub log: &'a [PathBuf],
    /// Vehicle files with the assumed parameters.
    pub vehicle: &'a [PathBuf],
    /// Oracle files with the true vehicles and noise levels.
    pub oracle: &'a [PathBuf],
}

/// The files of one run.
#[derive(Debug)]
pub struct Companions {
    log: Option<PathBuf>,
    log_is_named: bool,
    vehicle: Option<PathBuf>,
    oracle: Option<PathBuf>,
}

impl Companions {
    /// Finds the files of run number `index`, whose truth is `truth`.
    #[must_use]
    pub fn of(named: NamedFiles, index: usize, truth: &Path) -> Self {
        let name = truth
            .file_name()
            .and_then(|file| file.to_str()?.strip_suffix(TRUTH));
        let beside = |patterns: &[&str]| {
            let name = name?;
            patterns
                .iter()
                .map(|pattern| truth.with_file_name(pattern.replace(NAME, name)))
                .find(|path| path.exists())
        };
        let find = |files: &[PathBuf], patterns: &[&str]| match files {
            [] => beside(patterns),
            [for_all] => Some(for_all.clone()),
            each => each.get(index).cloned(),
        };
        Self {
            log: find(named.log, &["NAME.log", "NAME.log.gz"]),
            log_is_named: !named.log.is_empty(),
            vehicle: find(named.vehicle, &["NAME.vehicle.toml", "vehicle.toml"]),
            oracle: find(named.oracle, &["NAME.oracle.toml"]),
        }
    }

    /// Returns all these files.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = [&self.log, &self.vehicle, &self.oracle];
        files.into_iter().filter_map(|path| path.as_deref())
    }

    /// Returns the log, if it was named on the command line.
    #[must_use]
    pub fn named_log(&self) -> Option<&Path> {
        self.log.as_deref().filter(|_| self.log_is_named)
    }

    /// Returns messages on the files that are missing for a full table.
    #[must_use]
    pub fn missing(&self) -> Vec<&'static str> {
        if self.log.is_none() {
            return vec![
                "original, modified and oracle left out: no log (expected NAME.log or NAME.log.gz \
                 beside NAME.truth.csv, or --log)",
            ];
        }
        let vehicle = self.vehicle.is_none().then_some(
            "original and modified left out: no vehicle file (expected NAME.vehicle.toml or \
             vehicle.toml beside NAME.truth.csv, or --vehicle)",
        );
        let oracle = self.oracle.is_none().then_some(
            "oracle left out: no oracle file (expected NAME.oracle.toml beside NAME.truth.csv, or \
             --oracle)",
        );
        vehicle.into_iter().chain(oracle).collect()
    }

    /// Returns the comparison estimates that these files allow.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or used.
    pub fn rivals(&self, rows: &[RunRow]) -> Result<Vec<Rival>> {
        let vehicle = self.vehicle.as_deref().map(VehicleFile::read).transpose()?;
        let oracle = self.oracle.as_deref().map(OracleFile::read).transpose()?;
        let Some(log) = &self.log else {
            return Ok(Vec::new());
        };
        kind_of(log)?;
        if vehicle.is_none() && oracle.is_none() {
            return Ok(Vec::new());
        }
        rivals::of_log(log, vehicle.as_ref(), oracle.as_ref(), mean_speed_mps(rows))
    }
}
