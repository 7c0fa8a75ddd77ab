//! Smoothing of a whole run on a host.

mod cell_ranges;
mod disagreements;
mod drifts;
mod filtered_cell;
mod inferred_run;
mod misfit;
mod model_steps;
mod samples;
mod stuck_torques;
mod whole_run;

pub use cell_ranges::CellRanges;
pub use disagreements::Disagreements;
pub use filtered_cell::ForwardCell;
pub use inferred_run::smooth_inferred;
pub use samples::Samples;
pub use whole_run::{SmoothedCell, held_bytes, smooth_run, smooth_segments};
