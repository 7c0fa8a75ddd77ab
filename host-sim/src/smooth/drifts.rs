//! Drifts of GNSS altitude, and samples without them.

use estimator_core::filter::AltitudeEvent;
use estimator_core::sample::{AltitudeContinuity, Sample};
use std::ops::RangeInclusive;

/// Ranges of cells in which GNSS altitude drifted, in order and disjoint.
#[derive(Clone, Debug, Default)]
pub(super) struct Drifts(Vec<RangeInclusive<u32>>);

impl Drifts {
    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds the drift that ended at this cell, if the event is one.
    pub(super) fn note(&mut self, event: Option<AltitudeEvent>, cell: u32) {
        let Some(AltitudeEvent::DriftEnded(mut since)) = event else {
            return;
        };
        while let Some(before) = self.0.pop_if(|before| *before.end() >= since) {
            since = since.min(*before.start());
        }
        self.0.push(since..=cell);
    }

    /// Returns the sample, without its altitude if that drifted. After a drift the slow error of
    /// the receiver may have any value.
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
