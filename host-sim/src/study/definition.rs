//! Definition of a study.

use crate::error;
use crate::report::page::Section;
use std::path::PathBuf;

/// Settings of a study.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Folder of the measured data: `ztbus/*.csv`, `srtm/*.hgt`, `i3/Trip*.csv.gz` and
    /// `e4/road.csv`.
    pub data: PathBuf,
    /// Seed of every random number.
    pub seed: u64,
}

/// The measured profile of the E4, in the folder of the data.
const E4_ROAD: &str = "e4/road.csv";

impl Setting {
    /// Returns the file of the measured profile of the E4.
    ///
    /// # Errors
    /// Returns the outcome of a study that needs it if it is missing.
    pub fn e4_road(&self) -> Result<PathBuf, StudyOutcome> {
        let road = self.data.join(E4_ROAD);
        if road.exists() {
            return Ok(road);
        }
        Err(StudyOutcome::Skipped(format!(
            "{} is missing; expected the measured profile of the E4 (--data DIR)",
            road.display()
        )))
    }
}

/// Outcome of a study.
#[derive(Clone, Debug)]
pub enum StudyOutcome {
    /// Computed.
    Done(Section),
    /// Skipped because measured data are missing; says which.
    Skipped(String),
}

/// One study.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Name on the command line.
    pub name: &'static str,
    /// One line on what the study shows.
    pub about: &'static str,
    /// Runs the study.
    pub run: fn(&Setting) -> error::Result<StudyOutcome>,
}
