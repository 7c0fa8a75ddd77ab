//! A slope that was measured directly: by the vertical speed, or by a pitch sensor.

use super::applied::Update;
use super::row::Row;
use crate::filter::cell_input::CellInput;
use crate::filter::state::{Quantity, State};
use crate::filter::state_index::StateIndex::{Bias, DoubtfulForce, Retarder, Scale, Slope, Wind};
use crate::scalar::Scalar;

impl<S: Scalar> State<S> {
    /// Returns its row: of the road, or of the slope that the force balance reads.
    #[inline(always)]
    pub(in crate::filter) fn slope_row(&self, cell: &CellInput) -> Row<S, 6> {
        let of_road = if cell.marks.slope_is_read {
            S::ZERO
        } else {
            S::ONE
        };
        Row([
            (Slope, S::ONE),
            (Bias, -of_road),
            (Wind, -of_road),
            (DoubtfulForce, -of_road),
            (Scale, of_road * self.net_traction),
            (Retarder, -(of_road * self.retarder)),
        ])
    }

    /// Updates with a slope.
    #[inline(never)] // Not for the vehicles without such a sensor.
    pub(in crate::filter) fn update_slope(
        &mut self,
        cell: &CellInput,
        variance: S,
        gate: Option<S>,
    ) -> Update<S> {
        let quantity = if cell.marks.slope_is_read {
            Quantity::ReadSlope
        } else {
            Quantity::RoadSlope
        };
        let (slope, cross) = self.quantity(quantity);
        let innovation = S::from_f32(cell.slope.value) - slope.mean;
        self.update(innovation, slope.variance + variance, &cross, gate)
    }
}
