//! Detection of brakes that no signal reports, by the deceleration of the vehicle.
//!
//! A brake that comes on while the engine drives nothing reads as a slope that no road begins with:
//! several percent within a few metres. A signal that reports no brake proves little: retarders have
//! none, switches break. The detector works only for engines: the braking of motors is part of a measured force, and its timing against
//! the speed makes larger steps than brakes do.

use crate::cell::CELL_LENGTH_M;
use crate::context::Context;
use crate::sample::ForceInputs;
use crate::scalar::Scalar;

/// Running means of the slope that the force balance reads: of the moment and of the road so far, %.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BrakeDetector {
    moment_percent: f32,
    road_percent: f32,
    /// Mean of the squared difference of the two, %².
    variance: f32,
    cells: u16,
    braked_cells: Option<u16>,
    speed_mps: Option<f32>,
}

impl BrakeDetector {
    /// Drops what is known: the next cell does not follow the last one.
    pub(super) fn restart(&mut self) {
        *self = Self::default();
    }

    /// Advances over a cell that ends at a speed. `is_invalid` is whether the force balance is known
    /// not to hold in it. Returns whether the vehicle brakes.
    pub(super) fn advance(
        &mut self,
        context: &Context,
        forces: &ForceInputs,
        speed_mps: f32,
        is_invalid: bool,
    ) -> bool {
        let Some(before_mps) = self.speed_mps.replace(speed_mps) else {
            return false;
        };
        if is_invalid {
            return self.braked_cells.is_some();
        }
        let tuning = &context.tuning.detection;
        let balance = context.model.vehicle.force_balance(forces);
        let (energy, before) = (0.5 * speed_mps * speed_mps, 0.5 * before_mps * before_mps);
        let gained = (energy - before) / CELL_LENGTH_M;
        let slope_percent =
            (balance.traction - balance.drag * energy - balance.rolling - gained) / balance.gravity;
        self.cells = self.cells.saturating_add(1);
        let weight = |cells: f32| 1.0 / Scalar::min(cells, f32::from(self.cells));
        let moment_weight = weight(tuning.undeclared_brake_moment_cells);
        self.moment_percent += moment_weight * (slope_percent - self.moment_percent);
        let excess_percent = self.moment_percent - self.road_percent;
        let limit_percent = Scalar::max(
            tuning.undeclared_brake_percent,
            tuning.undeclared_brake_sigmas * Scalar::sqrt(self.variance),
        );
        // Drivers do not brake and drive at once.
        let rolls = forces.traction_n <= 0.0;
        self.braked_cells = match self.braked_cells {
            None if rolls && excess_percent > limit_percent => Some(0),
            Some(cells) if cells >= tuning.undeclared_brake_longest_cells => {
                self.road_percent = self.moment_percent;
                None
            }
            Some(cells) if rolls && excess_percent > 0.5 * limit_percent => Some(cells + 1),
            _ => None,
        };
        if self.braked_cells.is_none() {
            let road_weight = weight(tuning.undeclared_brake_road_cells);
            self.road_percent += road_weight * (slope_percent - self.road_percent);
            let square = Scalar::min(
                limit_percent * limit_percent,
                excess_percent * excess_percent,
            );
            let variance_weight = weight(tuning.undeclared_brake_sigma_cells);
            self.variance += variance_weight * (square - self.variance);
        }
        self.braked_cells.is_some()
    }
}
