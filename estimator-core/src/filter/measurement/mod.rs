//! Measurements: one contract for all of them, and a file for what each one measures.
//!
//! | file | content |
//! |---|---|
//! | `row` | the states that a measurement sees |
//! | `update` | the scalar update that all of them use |
//! | `applied` | what it leaves |
//! | `speed` | v²/2, from wheels or shaft |
//! | `altitude` | altitude of a GNSS receiver |
//! | `slope` | a slope that was measured directly: pitch sensor, vertical speed |
//!
//! An accelerometer that stands in for the force is no measurement of a state: it is part of the
//! work of a cell.

pub(super) mod altitude;
mod applied;
mod row;
pub(super) mod slope;
pub(super) mod speed;
mod update;

use super::cell_input::CellInput;
use super::noise::CellNoise;
use super::state::Record;
use crate::scalar::Scalar;
pub use applied::Update;
pub(super) use row::Row;

/// What a measurement measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measurand {
    /// Kinetic energy per kilogram, v²/2, m²/s².
    Speed,
    /// Altitude above the first fix, m.
    Altitude,
    /// Slope, sine in %.
    Slope,
}

/// A measurement in a cell, beside what the filter predicted. The contract is that of PX4's
/// `estimator_aid_source1d`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<S> {
    /// What it measures, and so its unit.
    pub measurand: Measurand,
    /// What was read. The innovation also has the way from there to the end of the cell.
    pub observation: S,
    /// Variance of its noise, as the pass assumed it.
    pub variance: S,
    /// Observation less prediction.
    pub innovation: S,
    /// Variance of the innovation. A speed that no force explains has added its square.
    pub innovation_variance: S,
    /// Squared innovation over its variance: one on average.
    pub test_ratio: S,
    /// Base variance of the noise over the one that was assumed, 1.
    pub weight: S,
    /// Whether it corrected the prediction. It does not where the gate left it out, and where the state
    /// began with it: at the start, behind a gap, and at a speed that no force explains.
    pub used: bool,
}

impl<S: Scalar> Record<S> {
    /// Returns the measurements of the step, in the order of their updates. `noise` has the variances
    /// that the step used.
    #[must_use]
    pub fn measurements(
        &self,
        cell: &CellInput,
        noise: &CellNoise<S>,
    ) -> [Option<Measurement<S>>; 3] {
        use Measurand::{Altitude, Slope, Speed};
        let begins = cell.marks.gap;
        let speed_begins = begins || self.speed_steps;
        [
            (Speed, &self.speed, &cell.energy, noise.speed, speed_begins),
            (
                Altitude,
                &self.altitude,
                &cell.altitude,
                noise.altitude,
                begins,
            ),
            (Slope, &self.slope, &cell.slope, noise.slope, false),
        ]
        .map(|(measurand, update, reading, variance, begins)| {
            let update = update.as_ref()?;
            Some(Measurement {
                measurand,
                observation: S::from_f32(reading.value),
                variance,
                innovation: update.innovation,
                innovation_variance: update.innovation_variance,
                test_ratio: update.innovation.squared() / update.innovation_variance,
                weight: S::from_f32(reading.variance) / variance,
                used: update.used().is_some() && !begins,
            })
        })
    }
}
