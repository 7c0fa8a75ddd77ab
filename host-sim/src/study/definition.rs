//! What a study is.

use crate::error::Result;
use crate::report::page::Section;
use std::path::PathBuf;

/// What a study is given.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Where the measured data lie: `ztbus/*.csv` and `srtm/*.hgt`.
    pub data: PathBuf,
    /// Every random number follows from it.
    pub seed: u64,
}

/// What became of a study.
#[derive(Clone, Debug)]
pub enum StudyOutcome {
    /// Computed.
    Done(Section),
    /// The measured data it needs are not there; what is missing.
    Skipped(String),
}

/// One study.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// Computes it.
    pub run: fn(&Setting) -> Result<StudyOutcome>,
}
