//! The bench around `estimator-core`: sources of traffic, whole-run smoothing, maps, reports.

pub mod error;
pub mod output;
pub mod run_file;
pub mod source;
pub mod vehicle_file;
