//! A cell of a smoothed run.

use estimator_core::{CellEnd, Estimate};

/// A cell of a smoothed run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothedCell {
    /// End of the cell: distance and time.
    pub end: CellEnd,
    /// The estimate there, from all measurements of the run.
    pub estimate: Estimate,
    /// Whether nothing disagrees here, as far as the whole run tells.
    pub is_consistent: bool,
}
