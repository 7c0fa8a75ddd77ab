//! Cells of a run in which signals disagree.

use super::cell_ranges::CellRanges;
use estimator_core::Disagreement;

/// Ranges of cells in which signals disagree, for each kind of disagreement.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Disagreements([CellRanges; Disagreement::KINDS]);

impl Disagreements {
    /// Adds what disagrees in a cell, which is behind all that were added.
    pub(super) fn add(&mut self, disagreement: Disagreement, cell: u32) {
        for (ranges, is_present) in self.0.iter_mut().zip(disagreement.kinds()) {
            if is_present {
                ranges.add(cell, cell);
            }
        }
    }

    /// Returns the ranges of each kind, in the order of [`Disagreement::kinds`].
    #[must_use]
    pub const fn by_kind(&self) -> &[CellRanges; Disagreement::KINDS] {
        &self.0
    }
}
