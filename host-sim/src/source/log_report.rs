//! What the reading of a log tells besides its frames.

use estimator_core::Signal;

/// What the reading of a whole log tells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LogReport {
    /// Columns of a signal table that are not ours.
    pub ignored_columns: Vec<String>,
    /// Own signals that no frame had.
    pub unseen_signals: Vec<Signal>,
}
