//! Definition of a study.

use crate::error::Result;
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
    pub run: fn(&Setting) -> Result<StudyOutcome>,
}
