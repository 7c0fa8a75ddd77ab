//! The measurements of a drive beside what the filter predicted.

use crate::error::Result;
use crate::files::csv::CsvTable;
use crate::files::output::Staged;
use crate::files::spool::{Spool, blocks, no_room};
use crate::numeric::rounding::round;
use estimator_core::filter::{Measurand, Measurement};
use estimator_core::{CellEnd, Instant};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// Bytes of a row.
const ROW_SLOT: usize = 42;

/// A row of INNOVATIONS.csv: a measurement in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InnovationRow {
    /// Driven distance at the end of the cell, m.
    pub distance_m: f64,
    /// Time since the first frame of the log, s.
    pub time_s: f64,
    /// What is measured.
    pub measurement: Measured,
    /// What was read, in the unit of the measurement.
    pub observation: f32,
    /// Variance of its noise.
    pub variance: f32,
    /// Observation less prediction.
    pub innovation: f32,
    /// Variance of the innovation.
    pub innovation_variance: f32,
    /// Squared innovation over its variance.
    pub test_ratio: f32,
    /// Base variance over the variance.
    pub weight: f32,
    /// 1 if it corrected the prediction.
    pub used: u8,
}

/// What is measured, as the file names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measured {
    /// v²/2, m²/s².
    Speed,
    /// Altitude of the receiver, m.
    Altitude,
    /// Sine of the slope, %.
    Slope,
}

impl InnovationRow {
    fn new(start: Instant, end: &CellEnd, measurement: &Measurement<f64>) -> Self {
        Self {
            distance_m: round(end.distance_m(), 2),
            time_s: round(end.time.since(start).as_secs_f64(), 4),
            measurement: match measurement.measurand {
                Measurand::Speed => Measured::Speed,
                Measurand::Altitude => Measured::Altitude,
                Measurand::Slope => Measured::Slope,
            },
            observation: measurement.observation as f32,
            variance: measurement.variance as f32,
            innovation: measurement.innovation as f32,
            innovation_variance: measurement.innovation_variance as f32,
            test_ratio: measurement.test_ratio as f32,
            weight: measurement.weight as f32,
            used: measurement.used.into(),
        }
    }
}

/// The measurements of a drive, in memory or in a temporary file.
#[derive(Debug, Default)]
pub struct Innovations(Spool<InnovationRow, ROW_SLOT>);

impl Innovations {
    /// Returns what adds the measurements of a drive that began at `start`.
    pub(super) fn sink(
        &mut self,
        start: Instant,
    ) -> impl FnMut(&CellEnd, &Measurement<f64>) -> io::Result<()> {
        move |end, measurement| self.0.push(&InnovationRow::new(start, end, measurement))
    }

    /// Writes them as CSV to a file that appears when it is committed.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn stage(&mut self, path: &Path) -> Result<Staged> {
        let mut table = CsvTable::begin(path)?;
        for block in blocks(0..self.0.count()) {
            for row in self.0.read(block).map_err(no_room)? {
                table.push(&row)?;
            }
        }
        table.finish()
    }
}
