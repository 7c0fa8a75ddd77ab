//! The force balance (thesis eq. 5 to 9), and the forces that it sums.
//!
//! This is the core's one place for weight, air resistance and eq. 9. The simulator and the
//! thesis's methods on the host keep their own: the truth must not share the core's mistakes.

use super::parameters::VehicleParameters;
use crate::sample::ForceInputs;

/// Standard gravity, m/s².
pub const GRAVITY: f32 = 9.806_65;

/// Air density where neither pressure nor temperature is known, kg/m³.
pub const STANDARD_AIR_DENSITY: f32 = 1.2;

/// Specific gas constant of dry air, J/(kg K).
const GAS_CONSTANT: f32 = 287.05;

/// The force balance in specific form: forces divided by the accelerated mass.
///
/// With e = v²/2 the kinetic energy per kilogram and s the sine of the slope angle, eq. 9 is linear
/// in distance x: de/dx = traction − drag·e − rolling − gravity·s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceBalance {
    /// Traction force over accelerated mass, m/s².
    pub traction: f32,
    /// Air resistance over accelerated mass and e, 1/m.
    pub drag: f32,
    /// Rolling resistance over accelerated mass, m/s².
    pub rolling: f32,
    /// Weight over accelerated mass, m/s² for one percent of slope (sine).
    pub gravity: f32,
}

impl VehicleParameters {
    /// Returns eq. 9 for the given forces, over the accelerated mass `mass_kg + rotating_kg`.
    #[must_use]
    pub fn force_balance(&self, forces: &ForceInputs) -> ForceBalance {
        let per_kg = 1.0 / forces.accelerated_kg();
        let weight = forces.weight_n() * per_kg;
        ForceBalance {
            traction: forces.traction_n * per_kg,
            drag: self.drag_area_m2 * forces.air_density * per_kg,
            rolling: weight * self.rolling_resistance,
            gravity: weight * 0.01,
        }
    }

    /// Returns the air resistance at a speed in still air, N (thesis eq. 5).
    #[must_use]
    pub fn drag_n(&self, forces: &ForceInputs, speed_mps: f32) -> f32 {
        forces.drag_n(self.drag_area_m2, speed_mps)
    }
}

impl ForceInputs {
    /// Returns the weight of the combination, N.
    #[must_use]
    pub fn weight_n(&self) -> f32 {
        self.mass_kg * GRAVITY
    }

    /// Returns the mass that the traction force accelerates: the combination and its rotating
    /// parts, kg.
    #[must_use]
    pub fn accelerated_kg(&self) -> f32 {
        self.mass_kg + self.rotating_kg
    }

    /// Returns the air resistance of a drag area in m², N (thesis eq. 5). `air_mps` is the speed of
    /// the air that meets the vehicle, m/s; air from behind is negative and pushes.
    #[must_use]
    pub fn drag_n(&self, drag_area_m2: f32, air_mps: f32) -> f32 {
        0.5 * drag_area_m2 * self.air_density * air_mps * air_mps.abs()
    }
}

/// Returns the density of dry air, kg/m³. It is [`STANDARD_AIR_DENSITY`] where the pressure is not
/// from 50 to 110 kPa, the temperature not from -60 to 60 °C, or one of them is missing.
#[must_use]
pub fn air_density(pressure_pa: Option<f32>, ambient_celsius: Option<f32>) -> f32 {
    match (pressure_pa, ambient_celsius) {
        (Some(pressure), Some(celsius))
            if (50_000.0..=110_000.0).contains(&pressure) && (-60.0..=60.0).contains(&celsius) =>
        {
            pressure / (GAS_CONSTANT * (celsius + 273.15))
        }
        _ => STANDARD_AIR_DENSITY,
    }
}
