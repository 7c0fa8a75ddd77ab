//! Brakes that nobody tells of, guessed from how the vehicle slows down.
//!
//! A brake that comes on while the engine drives nothing reads as a slope that no road begins
//! with: several percent within a few metres. Only where no brake signal is heard at all, and only
//! for engines: what motors brake with is in a measured force, and its timing against the speed
//! makes larger steps than brakes do.

use crate::cell::CELL_LENGTH_M;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{Load, VehicleParameters};

/// Cells over which the slope of the moment is averaged: noise of the wheel speed.
const MOMENT_CELLS: f32 = 4.0;
/// Cells over which the slope of the road is averaged.
const ROAD_CELLS: f32 = 40.0;
/// Cells over which the spread of the one around the other is averaged, and how many of its
/// standard deviations are no spread any more.
const SPREAD_CELLS: f32 = 400.0;
const SPREADS: f32 = 4.0;
/// Cells after which what looked like a brake was a slope after all: 500 m.
const LONGEST_CELLS: u16 = 200;

/// The slope that the force balance reads, of the moment and of the road so far, %.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slowing {
    moment_percent: f32,
    road_percent: f32,
    /// Mean of the squared difference of the two.
    spread: f32,
    cells: u16,
    braked_cells: Option<u16>,
    speed_mps: Option<f32>,
}

impl Slowing {
    /// Nothing is known of what came before.
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }

    /// Goes over a cell that ends at a speed. `told` is whether the force balance is known to be
    /// off in it. True if the vehicle slows down as only brakes make it.
    pub(super) fn brakes(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        load: &Load,
        speed_mps: f32,
        told: bool,
    ) -> bool {
        let Some(before_mps) = self.speed_mps.replace(speed_mps) else {
            return false;
        };
        if told {
            return self.braked_cells.is_some();
        }
        let balance = vehicle.force_balance(load);
        let (energy, before) = (0.5 * speed_mps * speed_mps, 0.5 * before_mps * before_mps);
        let gained = (energy - before) / CELL_LENGTH_M;
        let slope_percent =
            (balance.traction - balance.drag * energy - balance.rolling - gained) / balance.gravity;
        self.cells = self.cells.saturating_add(1);
        let weight = |cells: f32| 1.0 / f32::from(self.cells).min(cells);
        self.moment_percent += weight(MOMENT_CELLS) * (slope_percent - self.moment_percent);
        let excess_percent = self.moment_percent - self.road_percent;
        let limit_percent = (SPREADS * Scalar::sqrt(self.spread)).max(tuning.slowing_percent);
        // Nobody brakes and drives at once.
        let rolls = load.traction_n <= 0.0;
        self.braked_cells = match self.braked_cells {
            None if rolls && excess_percent > limit_percent => Some(0),
            Some(LONGEST_CELLS) => {
                self.road_percent = self.moment_percent;
                None
            }
            Some(cells) if rolls && excess_percent > 0.5 * limit_percent => Some(cells + 1),
            _ => None,
        };
        if self.braked_cells.is_none() {
            self.road_percent += weight(ROAD_CELLS) * (slope_percent - self.road_percent);
            let square = (excess_percent * excess_percent).min(limit_percent * limit_percent);
            self.spread += weight(SPREAD_CELLS) * (square - self.spread);
        }
        self.braked_cells.is_some()
    }
}
