//! Altitude of a GNSS receiver.

use super::applied::Update;
use super::row::Row;
use crate::filter::cell_input::CellInput;
use crate::filter::state::{Quantity, State};
use crate::filter::state_index::StateIndex::{Altitude, FastGnssError, SlowGnssError};
use crate::scalar::Scalar;

/// Returns its row: the coloured errors of the receiver are states.
#[inline(always)]
pub(in crate::filter) fn row<S: Scalar>() -> Row<S, 3> {
    Row([Altitude, SlowGnssError, FastGnssError].map(|index| (index, S::ONE)))
}

impl<S: Scalar> State<S> {
    /// Updates with an altitude.
    #[inline(always)]
    pub(in crate::filter) fn update_altitude(
        &mut self,
        cell: &CellInput,
        variance: S,
        gate: Option<S>,
    ) -> Update<S> {
        let row = row();
        let slope = self.mean_of(Quantity::RoadSlope);
        let rise = S::from_f32(0.01 * cell.altitude_behind_m) * slope;
        let measured = S::from_f32(cell.altitude.value) + rise;
        let cross = row.cross(&self.covariance);
        let innovation = measured - row.of(&self.mean);
        let innovation_variance = row.of(&cross) + variance;
        self.update(innovation, innovation_variance, &cross, gate)
    }
}
