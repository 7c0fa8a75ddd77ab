//! The grade that another device sends in PCC1, from a map of its own, against ours.

use crate::source::can_frame::CanFrame;
use embedded_can::{Frame, Id};
use estimator_core::broadcast::PCC1_PGN;
use estimator_core::signal::Pgn;
use estimator_core::{Live, Reading, Signal};
use serde::Serialize;

/// SPN 7432: byte of PCC1, step and offset in %, and largest raw value that is no code.
const BYTE: usize = 3;
const STEP_PERCENT: f64 = 0.125;
const OFFSET_PERCENT: f64 = -16.0;
const LARGEST: u8 = 250;

/// Differences of the received grade from the live grade at that time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RoadwayGrade {
    count: u64,
    sum_percent: f64,
    sum_of_squares: f64,
}

/// The grade of another device in comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoadwayComparison {
    /// Number of grades that were compared.
    readings: u64,
    /// Mean of the received grade less the live one, without a map, %.
    mean_difference_percent: f64,
    /// Root mean square of the same, %.
    rms_difference_percent: f64,
}

impl RoadwayGrade {
    /// Takes a frame, with the live estimate at that time.
    pub(super) fn frame(&mut self, frame: &CanFrame, live: impl FnOnce() -> Option<Live>) {
        let Id::Extended(id) = frame.id() else { return };
        if Pgn::from_raw(id.as_raw()).number != PCC1_PGN {
            return;
        }
        if let Some(raw) = frame.data().get(BYTE).filter(|raw| **raw <= LARGEST) {
            let grade_percent = OFFSET_PERCENT + STEP_PERCENT * f64::from(*raw);
            self.compare(grade_percent, live());
        }
    }

    /// Takes a reading of a signal table, with the live estimate at that time.
    pub(super) fn reading(&mut self, reading: Reading, live: impl FnOnce() -> Option<Live>) {
        if let (Signal::RoadwayGrade, Some(grade)) = (reading.signal, reading.value.real()) {
            self.compare(grade.into(), live());
        }
    }

    fn compare(&mut self, grade_percent: f64, live: Option<Live>) {
        let Some(live) = live else { return };
        let difference = grade_percent - f64::from(live.estimate.grade_percent.value);
        self.count += 1;
        self.sum_percent += difference;
        self.sum_of_squares += difference * difference;
    }

    /// Returns the comparison; `None` if nothing was compared.
    pub(super) fn comparison(&self) -> Option<RoadwayComparison> {
        let count = self.count as f64;
        (self.count > 0).then(|| RoadwayComparison {
            readings: self.count,
            mean_difference_percent: self.sum_percent / count,
            rms_difference_percent: (self.sum_of_squares / count).sqrt(),
        })
    }
}

impl RoadwayComparison {
    /// Returns the comparison in words.
    #[must_use]
    pub(super) fn words(&self) -> String {
        format!(
            "{:+.2} mean, {:.2} RMS of {}",
            self.mean_difference_percent, self.rms_difference_percent, self.readings
        )
    }
}
