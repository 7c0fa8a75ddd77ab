//! The bench around `estimator-core`: sources of traffic, whole-run smoothing, maps, reports.

pub mod bare_model;
pub mod baseline;
pub mod cli;
pub mod diagnose;
pub mod error;
pub mod events;
pub mod kept_file;
pub mod map;
pub mod oracle_file;
pub mod output;
pub mod progress;
pub mod recorder;
pub mod report;
pub mod robust_line;
pub mod row_check;
pub mod run_file;
pub mod score;
pub mod series;
pub mod smooth;
pub mod source;
pub mod study;
pub mod text_table;
pub mod truth_file;
pub mod vehicle_file;
pub mod world;
