//! What disagrees in a step, as its tests find it.

use super::altitude_gate::AltitudeEvent;
use super::altitude_update::Gated;
use crate::cell::Disagreement;
use crate::sample::Sample;
use crate::scalar::Scalar;

/// What disagrees in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepDisagreement {
    pub kinds: Disagreement,
    /// Number of cells, up to that of the step, in which it does.
    pub cells: u32,
    /// Whether what disagreed is undone at the cell's end.
    pub is_undone: bool,
}

impl StepDisagreement {
    /// Begins with what disagrees in the sample, and the number of cells in which an accelerometer
    /// disagrees with the force.
    pub(super) fn of(sample: &Sample, disagreeing_force: Option<u32>) -> Self {
        let mut of = Self {
            kinds: sample.disagreement,
            cells: sample.disagreeing_cells.into(),
            is_undone: false,
        };
        if let Some(cells) = disagreeing_force {
            of.kinds.torque = true;
            of.add_cells(cells);
        }
        of
    }

    /// Adds a brake that no signal reports.
    pub(super) fn add_brake(&mut self, cells: u32) {
        self.kinds.brake = true;
        self.add_cells(cells);
    }

    /// Adds what the gate of altitudes found. Returns whether it is a torque that is stuck.
    pub(super) fn add_altitude<S: Scalar>(&mut self, gated: &Gated<S>, cell: u32) -> bool {
        let Some(cells) = gated.disagreeing_cells(cell) else {
            return false;
        };
        self.is_undone = gated.undoes_error && self.kinds.is_none();
        let is_torque = matches!(gated.event, Some(AltitudeEvent::TorqueStuck { .. }));
        if is_torque {
            self.kinds.torque = true;
        } else {
            self.kinds.climb = true;
        }
        self.add_cells(cells);
        is_torque
    }

    fn add_cells(&mut self, cells: u32) {
        self.cells = self.cells.max(cells);
    }
}
