//! Tables and figures, computed: one file a study.
//!
//! A study is a function from [`Setting`] to a [`Section`] of the report; its tables and figures
//! are written beside the page by their names. Adding one takes a file and a line in [`STUDIES`].

pub mod accuracy;
pub mod convergence;
pub mod distance_drive;
pub mod drift;
pub mod experiments;
pub mod fleet;
pub mod gps;
pub mod sensitivity;
pub mod windows;
pub mod ztbus;

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
pub enum Outcome {
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
    pub run: fn(&Setting) -> Result<Outcome>,
}

/// Every study, in the order of the report.
pub const STUDIES: &[Study] = &[
    sensitivity::STUDY,
    experiments::pointwise::STUDY,
    gps::STUDY,
    convergence::STUDY,
    experiments::model_errors::STUDY,
    experiments::tuning::STUDY,
    experiments::modified::STUDY,
    experiments::campaigns::STUDY,
    accuracy::STUDY,
    fleet::STUDY,
    ztbus::STUDY,
];
