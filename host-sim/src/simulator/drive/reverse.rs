//! Reversing: the force balance solved for the torque, because the speed is given.

use super::Journey;
use super::state::{DriveState, STEP_S};
use crate::numeric::slope::sine;
use crate::simulator::truck::{GRAVITY, IDLE_RPM};

/// Forward gear that has the ratio of the reverse gear.
const REVERSE_GEAR: usize = 1;
/// Position of the brake pedal while reversing downhill, %.
const REVERSE_PEDAL: f64 = 10.0;

impl Journey<'_> {
    /// Advances backwards at a given speed, m/s; the engine or the brake gives the force for it.
    pub(super) fn reverse(&mut self, speed_mps: f64, acceleration_mps2: f64) -> DriveState {
        let gear = REVERSE_GEAR;
        let before_rpm = self.engine_rpm;
        let turned_rpm = self.truck.engine_rpm(gear, speed_mps);
        let slips = turned_rpm < IDLE_RPM;
        self.engine_rpm = turned_rpm.max(IDLE_RPM);
        let accelerated_kg = self.truck.accelerated_kg(if slips { 0 } else { gear });
        let resistance_n = self.truck.resistance_n(speed_mps, self.air_density)
            - self.truck.mass_kg * GRAVITY * sine(self.road.grade(self.distance_m));
        let force_n = accelerated_kg * acceleration_mps2 + resistance_n;
        let per_torque = self.truck.force_per_torque(gear);
        self.net_torque_nm = force_n.max(0.0) / per_torque;
        let brake_n = (-force_n).max(0.0);
        let state = DriveState {
            distance_m: self.distance_m,
            set_back_m: self.set_back_m,
            speed_mps,
            acceleration_mps2,
            traction_n: self.net_torque_nm * per_torque,
            accelerated_kg,
            brake_n,
            retarder_n: 0.0,
            brake_pedal_percent: if brake_n > 0.0 { REVERSE_PEDAL } else { 0.0 },
            parked: false,
            net_torque_nm: self.net_torque_nm,
            friction_torque_nm: self.truck.friction_nm(before_rpm),
            engine_rpm: self.engine_rpm,
            gear,
            in_reverse: true,
            range_ratio: self.truck.range_ratio(),
            carried_mps: 0.0,
            selected_gear: gear,
            shifting: false,
            engaged: !slips,
            clutch_slip_percent: if slips {
                100.0 * (1.0 - turned_rpm / IDLE_RPM)
            } else {
                0.0
            },
            fan_percent: self.planted.fan_percent(),
        };
        let back_m = STEP_S * (speed_mps + 0.5 * STEP_S * acceleration_mps2);
        self.distance_m -= back_m;
        self.set_back_m += back_m;
        state
    }
}
