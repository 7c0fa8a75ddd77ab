//! Cells of a run in which signals disagree.

use super::cell_ranges::CellRanges;
use estimator_core::Disagreement;
use estimator_core::filter::StepRecord;
use std::ops::RangeInclusive;

/// Ranges of cells in which signals disagree, for each kind of disagreement.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Disagreements([CellRanges; Disagreement::KINDS]);

impl Disagreements {
    /// Adds what disagrees in the cell of a step, and in the cells before it that the step names.
    pub(super) fn note<S>(&mut self, record: &StepRecord<S>) {
        let cell = record.end.cell;
        let since = cell.saturating_sub(record.disagreeing_cells.saturating_sub(1));
        for (ranges, is_present) in self.0.iter_mut().zip(record.disagreement.kinds()) {
            if is_present {
                ranges.add(since, cell);
            }
        }
    }

    /// Adds what disagrees in a cell, which is behind all that were added.
    pub(super) fn add(&mut self, disagreement: Disagreement, cell: u32) {
        for (ranges, is_present) in self.0.iter_mut().zip(disagreement.kinds()) {
            if is_present {
                ranges.add(cell, cell);
            }
        }
    }

    /// Returns whether anything disagrees in a cell.
    pub(super) fn cover(&self, cell: u32) -> bool {
        self.0.iter().any(|ranges| ranges.contains(cell))
    }

    /// Returns whether anything but the climb disagrees in one of these cells: a signal is wrong there,
    /// and not the model.
    pub(super) fn signals_disagree(&self, cells: &RangeInclusive<u32>) -> bool {
        let climb = Disagreement {
            climb: true,
            ..Disagreement::default()
        };
        let kinds = self.0.iter().zip(climb.kinds());
        kinds
            .filter(|(_, is_climb)| !is_climb)
            .any(|(ranges, _)| ranges.meet(cells))
    }

    /// Returns the ranges of each kind, in the order of [`Disagreement::kinds`].
    #[must_use]
    pub const fn by_kind(&self) -> &[CellRanges; Disagreement::KINDS] {
        &self.0
    }
}
