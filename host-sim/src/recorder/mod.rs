//! One drive through the core: traffic in, a run out.
//!
//! What grows with the drive is stored in [spools](crate::files::spool), 250 bytes a cell
//! (100 kB/km), so that the memory held does not.

mod drive_recorder;
mod estimate_log;
mod long_run;
mod missing;
mod summary;

pub use drive_recorder::Recorder;
pub use estimate_log::estimate_log;
pub use long_run::{LongRun, Rows, Run};
pub use missing::missing;
pub use summary::Summary;
