//! The bench around `estimator-core`: sources of traffic, whole-run smoothing, maps, reports.

#![warn(missing_docs)]
// A closed stdout or stderr must not panic: terminal::print has the functions for both.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod cli;
pub mod comparison;
pub mod diagnose;
pub mod error;
pub mod files;
pub mod identify;
pub mod inertial_judge;
pub mod inspect;
#[cfg(target_os = "linux")]
pub mod live;
pub mod logs_to_map;
pub mod map;
pub mod numeric;
pub mod platform;
pub mod recorder;
pub mod report;
pub mod score;
pub mod simulator;
pub mod smooth;
pub mod source;
#[cfg(feature = "studies")]
pub mod study;
pub mod terminal;
