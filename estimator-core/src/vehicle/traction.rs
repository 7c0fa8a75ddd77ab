//! From engine torque to force at the wheels, and the mass that turns with them (thesis eq. 1-4 and
//! 9).

use super::parameters::VehicleParameters;
use super::powertrain::{Driveline, Traction};

impl VehicleParameters {
    /// Returns the force at the wheels for a net engine torque in percent of the reference torque, N
    /// (thesis eq. 9, left side). It is 0 unless a gear is engaged. `wheel_radius_m` is the radius
    /// that the wheels are believed to have.
    #[must_use]
    pub fn traction_n(
        &self,
        driveline: Driveline,
        net_torque_percent: f32,
        wheel_radius_m: f32,
    ) -> f32 {
        match (&self.traction, driveline) {
            (Traction::Powertrain(p), Driveline::Engaged(gear)) => {
                let torque_nm = p.reference_torque_nm * net_torque_percent * 0.01;
                torque_nm
                    * gear.ratio
                    * gear.efficiency
                    * p.final_drive_ratio
                    * p.final_drive_efficiency
                    / wheel_radius_m
            }
            _ => 0.0,
        }
    }

    /// Returns the mass that the wheels and, through the engaged gear, the engine add, kg (thesis
    /// eq. 9).
    #[must_use]
    pub fn rotating_kg(&self, driveline: Driveline, wheel_radius_m: f32) -> f32 {
        let engine = match (&self.traction, driveline) {
            (Traction::Powertrain(p), Driveline::Engaged(gear)) => {
                let ratio = gear.ratio * p.final_drive_ratio;
                ratio * ratio * gear.efficiency * p.final_drive_efficiency * p.engine_inertia_kgm2
            }
            _ => 0.0,
        };
        (self.wheel_inertia_kgm2 + engine) / (wheel_radius_m * wheel_radius_m)
    }
}
