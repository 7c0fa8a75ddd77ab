//! The files that a run is judged with beside its truth: log, vehicle, oracle. Named on the command
//! line, or found beside the truth by their names.

use crate::error::Result;
use crate::files::oracle::{OracleFile, mean_speed_mps};
use crate::files::run::RunRow;
use crate::files::vehicle::VehicleFile;
use crate::score::rivals::{self, Rival};
use crate::source::log_kind::kind_of;
use std::path::{Path, PathBuf};

/// Stands for the drive's name in the names of files.
const NAME: &str = "NAME";
/// What a simulated drive's truth is called after the drive's name.
const TRUTH: &str = ".truth.csv";

/// The options that name them; each once for all runs, or once for each.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    /// The log that the run was estimated from; needed for the rows beside it. Once for all runs,
    /// or one for each [default: NAME.log or NAME.log.gz beside NAME.truth.csv].
    #[arg(long, value_name = "LOG")]
    pub log: Vec<PathBuf>,
    /// The vehicle as it was believed, for the thesis's methods; once or one for each run [default:
    /// NAME.vehicle.toml beside NAME.truth.csv, else vehicle.toml].
    #[arg(long, value_name = "V.toml")]
    pub vehicle: Vec<PathBuf>,
    /// The true vehicle and noise, for the oracle; once or one for each run [default:
    /// NAME.oracle.toml beside NAME.truth.csv].
    #[arg(long, value_name = "ORACLE.toml")]
    pub oracle: Vec<PathBuf>,
}

/// The files of one run.
#[derive(Debug)]
pub(super) struct Companions {
    log: Option<PathBuf>,
    log_is_named: bool,
    vehicle: Option<PathBuf>,
    oracle: Option<PathBuf>,
}

impl Companions {
    /// Those of run number `index`, whose truth is `truth`.
    pub(super) fn of(options: &Options, index: usize, truth: &Path) -> Self {
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
        let find = |named: &[PathBuf], patterns: &[&str]| match named {
            [] => beside(patterns),
            [for_all] => Some(for_all.clone()),
            each => each.get(index).cloned(),
        };
        Self {
            log: find(&options.log, &["NAME.log", "NAME.log.gz"]),
            log_is_named: !options.log.is_empty(),
            vehicle: find(&options.vehicle, &["NAME.vehicle.toml", "vehicle.toml"]),
            oracle: find(&options.oracle, &["NAME.oracle.toml"]),
        }
    }

    /// The log, if it was named on the command line.
    pub(super) fn named_log(&self) -> Option<&Path> {
        self.log.as_deref().filter(|_| self.log_is_named)
    }

    /// What is missing for a full table, in words.
    pub(super) fn missing(&self) -> Vec<&'static str> {
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

    /// What these files allow to be judged beside the run.
    ///
    /// # Errors
    /// A file that cannot be read or used.
    pub(super) fn rivals(&self, rows: &[RunRow]) -> Result<Vec<Rival>> {
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
