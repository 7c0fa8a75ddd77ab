//! Drifts of GNSS altitude, and samples without them.

use super::cell_ranges::CellRanges;
use estimator_core::filter::AltitudeEvent;
use estimator_core::sample::{AltitudeContinuity, Sample};

/// Ranges of cells in which GNSS altitude drifted.
#[derive(Clone, Debug, Default)]
pub(super) struct Drifts(CellRanges);

impl Drifts {
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the drift that ended at this cell, if the event is one.
    pub(super) fn note(&mut self, event: Option<AltitudeEvent>, cell: u32) {
        if let Some(AltitudeEvent::DriftEnded(since)) = event {
            self.0.add(since, cell);
        }
    }

    /// Returns the sample, without its altitude if that drifted. After a drift the slow error of
    /// the receiver may have any value.
    pub(super) fn without(&self, sample: &Sample, has_drifted: &mut bool) -> Sample {
        let mut sample = *sample;
        if self.0.contains(sample.end.cell) {
            sample.altitude = None;
            *has_drifted = true;
        } else if let Some(altitude) = sample.altitude.as_mut().filter(|_| *has_drifted) {
            if altitude.continuity == AltitudeContinuity::Followed {
                altitude.continuity = AltitudeContinuity::Drifted;
            }
            *has_drifted = false;
        }
        sample
    }
}
