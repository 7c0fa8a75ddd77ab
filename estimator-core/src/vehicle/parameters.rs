//! Parameters of a vehicle, as a vehicle file holds them.

use super::parameter_check::{Limits, ParameterError, check_all};
use super::powertrain::Traction;

/// What road vehicles have.
const LIMITS: [Limits; 5] = [
    Limits::new("vehicle.mass_kg", 500.0, 200_000.0, "500 to 200000 kg"),
    Limits::new("vehicle.drag_area_m2", 0.0, 30.0, "0 to 30 m²"),
    Limits::new("vehicle.rolling_resistance", 0.0, 0.1, "0 to 0.1"),
    Limits::new("vehicle.wheel_radius_m", 0.1, 2.0, "0.1 to 2 m"),
    Limits::new(
        "vehicle.wheel_inertia_kgm2",
        0.0,
        10_000.0,
        "0 to 10000 kg m²",
    ),
];

/// Parameters of a vehicle without effects (thesis eq. 1 to 9). SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleParameters {
    /// Mass of the whole combination, kg.
    pub mass_kg: f32,
    /// Drag coefficient times frontal area, m².
    pub drag_area_m2: f32,
    /// Rolling resistance coefficient, 1.
    pub rolling_resistance: f32,
    /// Effective radius of the driven wheels, m.
    pub wheel_radius_m: f32,
    /// Moment of inertia of all wheels, kg m².
    pub wheel_inertia_kgm2: f32,
    /// Where the traction force comes from.
    pub traction: Traction,
}

impl VehicleParameters {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter that is not finite or outside what road vehicles have.
    pub fn check(&self) -> Result<(), ParameterError> {
        let values = [
            self.mass_kg,
            self.drag_area_m2,
            self.rolling_resistance,
            self.wheel_radius_m,
            self.wheel_inertia_kgm2,
        ];
        check_all(&LIMITS, &values)?;
        match &self.traction {
            Traction::Powertrain(powertrain) => powertrain.check(),
            Traction::Force => Ok(()),
        }
    }
}
