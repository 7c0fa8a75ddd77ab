//! Torques that are stuck, and samples without them.

use super::cell_ranges::CellRanges;
use estimator_core::filter::AltitudeEvent;
use estimator_core::sample::Sample;

/// Ranges of cells that begin where a torque came to rest, and end where it was found to be stuck.
#[derive(Clone, Debug, Default)]
pub(super) struct StuckTorques(CellRanges);

impl StuckTorques {
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the torque that is found to be stuck at this cell, if the event is one.
    pub(super) fn note(&mut self, event: Option<AltitudeEvent>, cell: u32) {
        if let Some(AltitudeEvent::TorqueStuck { cells }) = event {
            self.0.add(cell.saturating_sub(cells), cell);
        }
    }

    /// Returns the sample, without its traction from where the torque came to rest to where it
    /// changes again.
    pub(super) fn without(&self, sample: &Sample, is_stuck: &mut bool) -> Sample {
        let mut sample = *sample;
        *is_stuck = self.0.contains(sample.end.cell) || (*is_stuck && sample.torque_rests);
        sample.end.condition.no_traction |= *is_stuck && sample.effect_inputs.engaged;
        sample
    }
}
