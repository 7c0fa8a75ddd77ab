//! Smoothing of a whole run on a host.
//!
//! | file | content |
//! |---|---|
//! | `samples` | the samples of a run, in memory or on disk |
//! | `smoothed_cell` | a cell of a smoothed run |
//! | `whole_run`, `piece` | a run in pieces; the estimates of a piece |
//! | `inferred` | the variances of a piece, inferred from all of it |
//! | `cell_ranges`, `disagreements` | where signals disagree |

mod cell_ranges;
mod disagreements;
mod inferred;
mod piece;
mod samples;
mod smoothed_cell;
mod whole_run;

pub use cell_ranges::CellRanges;
pub use disagreements::Disagreements;
pub use inferred::Inferred;
pub use piece::{MeasurementSink, Piece};
pub use samples::Samples;
pub use smoothed_cell::SmoothedCell;
pub use whole_run::{Known, smooth_pieces, smooth_run};
