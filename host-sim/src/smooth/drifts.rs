//! Where GNSS drifted, and the run without it.

use estimator_core::filter::AltitudeEvent;
use estimator_core::sample::{AltitudeContinuity, Sample};
use std::ops::RangeInclusive;

/// Cells from where GNSS began to drift to where it did no longer, in the order of the run and
/// apart from each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Drifts(Vec<RangeInclusive<u32>>);

impl Drifts {
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes up a drift that ended at this cell, if that is what happened there.
    pub(super) fn note(&mut self, event: Option<AltitudeEvent>, cell: u32) {
        let Some(AltitudeEvent::DriftEnded(mut since)) = event else {
            return;
        };
        while let Some(before) = self.0.pop_if(|before| *before.end() >= since) {
            since = since.min(*before.start());
        }
        self.0.push(since..=cell);
    }

    /// The sample, without its altitude if that drifted; behind a drift the receiver's slow error
    /// may have gone anywhere.
    pub(super) fn without(&self, sample: &Sample, has_drifted: &mut bool) -> Sample {
        let mut sample = *sample;
        let cell = sample.end.cell;
        let next = self.0.partition_point(|drift| *drift.end() < cell);
        if self.0.get(next).is_some_and(|drift| drift.contains(&cell)) {
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
