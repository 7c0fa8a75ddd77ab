//! The option `--tuning`, the same in every command that estimates.

use crate::error::Result;
use crate::files::tuning;
use estimator_core::Tuning;
use std::path::{Path, PathBuf};

/// The option `--tuning`.
#[derive(Debug, clap::Args)]
pub struct TuningOption {
    /// Tuning file with values for the estimator's parameters; docs/tuning.md lists them.
    #[arg(long, value_name = "FILE.toml", hide_short_help = true)]
    tuning: Option<PathBuf>,
}

impl TuningOption {
    /// Returns the file, if one is named.
    pub fn file(&self) -> Option<&Path> {
        self.tuning.as_deref()
    }

    /// Reads the file, or returns the defaults if there is none.
    ///
    /// # Errors
    /// Returns an error for a file that cannot be read or has an unknown key or value.
    pub fn read(&self) -> Result<Tuning> {
        tuning::read_or_default(self.tuning.as_deref())
    }
}
