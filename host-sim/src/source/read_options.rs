//! What a user asks of the reading of a log.

use super::own_signals::{ChannelMapping, OwnSignals};
use super::signal_table::ColumnsFile;
use crate::files::stop::Stop;
use estimator_core::Signal;
use std::sync::Arc;

/// How a log is read. The default reads all of it, and leaves out damage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Refuse a log with any damage, instead of one with more than 1 %.
    pub strict: bool,
    /// Read a log whose clock was set back as one drive.
    pub rejoin: bool,
    /// Read the frames of these interfaces only; of all if there is none.
    pub interfaces: Vec<String>,
    /// Leave out these signals, as if the bus did not have them.
    pub ignore: Vec<Signal>,
    /// Signals of the user's own messages. The built-in messages do not give these.
    pub signals: Option<Arc<OwnSignals>>,
    /// What the columns of tables are.
    pub columns: Option<Arc<ColumnsFile>>,
    /// Which channels of a log with decoded signals become ours, besides those that have the name of
    /// one.
    pub channels: Option<Arc<ChannelMapping>>,
    /// Stops the reading.
    pub stop: Stop,
}

/// Returns the signal of a column.
///
/// # Errors
/// Returns words that name the nearest signal.
pub fn signal_named(name: &str) -> Result<Signal, String> {
    // Words that begin alike: `fan` means `fan_percent`.
    let likeness = |signal: &Signal| strsim::jaro_winkler(name, signal.column());
    Signal::from_column(name).ok_or_else(|| {
        let mut known = Signal::ALL.to_vec();
        known.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
        let nearest = known.first().map_or("", |signal| signal.column());
        format!("no such signal; did you mean `{nearest}`?")
    })
}
