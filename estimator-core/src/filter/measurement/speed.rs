//! Speed of wheels or shaft, as v²/2.

use super::applied::Update;
use super::row::Row;
use crate::cell::CELL_LENGTH_M;
use crate::filter::cell_input::CellInput;
use crate::filter::state::State;
use crate::filter::state_index::StateIndex::{KineticEnergy, TyreSlip};
use crate::scalar::Scalar;
use crate::vehicle::GRAVITY;

/// Largest force over weight that a speed hides: hard braking.
const LARGEST_FORCE: f32 = 0.3;
/// Squared innovation of the speed over its variance beyond which it is no noise.
const STEP_RATIO: f32 = 25.0;

/// Returns its row: driven tyres slip.
#[inline(always)]
pub(in crate::filter) fn row<S: Scalar>(cell: &CellInput) -> Row<S, 2> {
    let per_slip = S::from_f32(cell.energy_per_slip);
    Row([(KineticEnergy, S::ONE), (TyreSlip, per_slip)])
}

impl<S: Scalar> State<S> {
    /// Updates with the speed. Returns also whether it stepped by more than any force can make it.
    #[inline(always)]
    pub(in crate::filter) fn update_speed(
        &mut self,
        cell: &CellInput,
        energy_before: S,
        variance: S,
    ) -> (Update<S>, bool) {
        let row = row(cell);
        let energy = self.mean[KineticEnergy as usize];
        let behind = S::from_f32(cell.energy_behind_m * (1.0 / CELL_LENGTH_M));
        let measured = S::from_f32(cell.energy.value) + behind * (energy - energy_before);
        let mut cross = row.cross(&self.covariance);
        let innovation = measured - row.of(&self.mean);
        let mut innovation_variance = row.of(&cross) + variance;
        let squared = innovation.squared();
        // No force changes a speed so: the sensor stuck, slipped, or another one took over.
        let most = S::from_f32(LARGEST_FORCE * GRAVITY * cell.since_speed_m);
        let steps =
            squared > most.squared() && squared > S::from_f32(STEP_RATIO) * innovation_variance;
        if steps {
            self.covariance.add(KineticEnergy, KineticEnergy, squared);
            cross[KineticEnergy as usize] += squared;
            innovation_variance += squared;
        }
        let update = self.update(innovation, innovation_variance, &cross, None);
        (update, steps)
    }
}
