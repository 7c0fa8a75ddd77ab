//! One drive through the core: inputs in, a run out.
//!
//! The data that grow with the drive are stored in [spools](crate::files::spool), 340 bytes per
//! cell (140 kB/km), so that memory use is constant.

mod drive_recorder;
mod estimate_log;
mod horizon_log;
mod innovations;
pub mod latencies;
mod long_run;
mod missing;
pub mod placed_samples;
mod plausibility;
mod replaced;
mod roads;
mod roadway_grade;
mod summary;
pub mod verdict;

pub use drive_recorder::Recorder;
pub use estimate_log::{estimate_log, estimate_logs, record_log, record_logs};
pub use horizon_log::{HorizonRow, horizons_of_log};
pub use innovations::{InnovationRow, Innovations, Measured};
pub use long_run::{LongRun, Rows, SmoothedRun};
pub use missing::{check_inputs, missing};
pub use plausibility::Warning;
pub use replaced::{ReplacedParameter, replaced};
pub use roads::LearnedRoads;
pub use roadway_grade::RoadwayComparison;
pub use summary::RunSummary;
