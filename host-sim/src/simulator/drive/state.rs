//! What a traversal leaves: the true state of each step.

use crate::simulator::road::Road;
use crate::simulator::truck::Truck;

/// Step of the integration, s. Speed changes by less than 0.02 m/s in it.
pub const STEP_S: f64 = 0.01;

/// The true state at the start of a step, and the forces during it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveState {
    /// Place on the travelled road, m.
    pub distance_m: f64,
    /// Way driven backwards, less that on ferries, m: driven distance minus place.
    pub set_back_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub acceleration_mps2: f64,
    /// Traction force before planted losses, N.
    pub traction_n: f64,
    /// Accelerated mass, rotating parts included, kg.
    pub accelerated_kg: f64,
    /// Force of the service brake, N.
    pub brake_n: f64,
    /// Force of the retarder, N.
    pub retarder_n: f64,
    /// Position of the brake pedal, %.
    pub brake_pedal_percent: f64,
    /// The parking brake is set.
    pub parked: bool,
    /// Net engine torque, Nm.
    pub net_torque_nm: f64,
    /// Friction torque of the engine, Nm, positive.
    pub friction_torque_nm: f64,
    /// Engine speed, rpm.
    pub engine_rpm: f64,
    /// Current gear as the gearbox reports it; 0 is neutral.
    pub gear: usize,
    /// True while the reverse gear is engaged; `gear` is then the one of the same ratio.
    pub in_reverse: bool,
    /// Ratio of the transfer case.
    pub range_ratio: f64,
    /// Speed at which a ferry carries the vehicle along the road, m/s.
    pub carried_mps: f64,
    /// Target gear.
    pub selected_gear: usize,
    /// True during a gear shift.
    pub shifting: bool,
    /// True if the driveline transmits torque without slip.
    pub engaged: bool,
    /// Slip of the clutch, %.
    pub clutch_slip_percent: f64,
    /// Fan speed as reported on the bus, %.
    pub fan_percent: f64,
}

impl DriveState {
    /// Returns true if a brake is applied.
    #[must_use]
    pub fn braking(&self) -> bool {
        self.brake_pedal_percent > 0.0 || self.brake_n > 0.0 || self.retarder_n > 0.0
    }

    /// Returns true if the vehicle moves backwards.
    #[must_use]
    pub fn is_reversing(&self) -> bool {
        self.in_reverse && self.speed_mps > 0.0
    }

    /// Returns the distance driven forwards, m. It stands still while the vehicle reverses.
    #[must_use]
    pub fn driven_m(&self) -> f64 {
        self.distance_m + self.set_back_m
    }
}

/// A simulated traversal.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    /// The road in the direction of travel.
    pub road: Road,
    /// The true vehicle.
    pub truck: Truck,
    /// One state per step of [`STEP_S`], from time 0.
    pub states: Vec<DriveState>,
}

impl SimulatedDrive {
    /// Returns the start of the last step, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.states.len().saturating_sub(1) as f64 * STEP_S
    }

    /// Returns the state at a time. Continuous quantities are interpolated between steps. Before
    /// the start and after the end it is the first or the last state.
    #[must_use]
    pub fn at(&self, time_s: f64) -> DriveState {
        let steps = (time_s / STEP_S).clamp(0.0, (self.states.len() - 1) as f64);
        let index = steps as usize;
        let from = self.states[index];
        let to = self.states[(index + 1).min(self.states.len() - 1)];
        let part = steps - index as f64;
        let between = |a: f64, b: f64| a + part * (b - a);
        DriveState {
            distance_m: between(from.distance_m, to.distance_m),
            set_back_m: between(from.set_back_m, to.set_back_m),
            speed_mps: between(from.speed_mps, to.speed_mps),
            engine_rpm: between(from.engine_rpm, to.engine_rpm),
            ..from
        }
    }
}
