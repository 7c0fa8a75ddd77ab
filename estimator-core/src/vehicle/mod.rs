//! The vehicle: parameters, and the force balance of the thesis (eq. 1-9).

use crate::effect::{Acts, Effects};

mod powertrain;
mod resistance;

pub use powertrain::{Driveline, Gear, MAX_GEARS, Powertrain, Traction};
pub use resistance::{STANDARD_AIR_DENSITY, air_density};

/// Standard gravity, m/s².
pub const GRAVITY: f32 = 9.806_65;

/// What a vehicle file says. SI units.
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
    /// What it is known to have besides.
    pub effects: Effects,
}

/// A parameter that no vehicle can have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// The effect that it is of, if it is of one.
    pub effect: Option<&'static str>,
    /// Key in the vehicle file.
    pub key: &'static str,
    /// The value found.
    pub value: f32,
    /// What would do.
    pub expected: &'static str,
}

impl core::fmt::Display for ParameterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(effect) = self.effect {
            write!(f, "effects.{effect}.")?;
        }
        write!(
            f,
            "{} = {}: expected {}",
            self.key, self.value, self.expected
        )
    }
}

impl ParameterError {
    /// The same of an effect.
    pub(crate) const fn of_effect(self, name: &'static str) -> Self {
        Self {
            effect: Some(name),
            ..self
        }
    }
}

impl core::error::Error for ParameterError {}

pub(crate) fn check(
    key: &'static str,
    value: f32,
    low: f32,
    high: f32,
    expected: &'static str,
) -> Result<(), ParameterError> {
    if value.is_finite() && value >= low && value <= high {
        Ok(())
    } else {
        Err(ParameterError {
            effect: None,
            key,
            value,
            expected,
        })
    }
}

impl VehicleParameters {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter that is not finite or outside what road vehicles have.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(
            "vehicle.mass_kg",
            self.mass_kg,
            500.0,
            200_000.0,
            "500 to 200000 kg",
        )?;
        check(
            "vehicle.drag_area_m2",
            self.drag_area_m2,
            0.0,
            30.0,
            "0 to 30 m²",
        )?;
        check(
            "vehicle.rolling_resistance",
            self.rolling_resistance,
            0.0,
            0.1,
            "0 to 0.1",
        )?;
        check(
            "vehicle.wheel_radius_m",
            self.wheel_radius_m,
            0.1,
            2.0,
            "0.1 to 2 m",
        )?;
        check(
            "vehicle.wheel_inertia_kgm2",
            self.wheel_inertia_kgm2,
            0.0,
            10_000.0,
            "0 to 10000 kg m²",
        )?;
        match &self.traction {
            Traction::Powertrain(powertrain) => powertrain.check()?,
            Traction::Force => {}
        }
        self.effects.check()
    }

    /// Radius that the driven wheels are believed to have, m.
    pub(crate) fn believed_radius_m(&self) -> f32 {
        self.wheel_radius_m * self.effects.factor(Acts::WheelRadius)
    }
}

/// The force balance in specific form: forces over the accelerated mass.
///
/// With e = v²/2 the kinetic energy per kilogram and s = sin of the slope, eq. 9 becomes linear
/// in distance:
/// de/dx = traction − drag·e − rolling − gravity·s.
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

/// What the force balance depends on besides the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Load {
    /// Net force at the driven wheels, N.
    pub traction_n: f32,
    /// Mass that rotating parts add, kg.
    pub rotating_kg: f32,
    /// Mass of the combination, kg.
    pub mass_kg: f32,
    /// Air density, kg/m³.
    pub air_density: f32,
}

impl VehicleParameters {
    /// Eq. 9 with the given load, over the accelerated mass `mass_kg + rotating_kg`.
    #[must_use]
    pub fn force_balance(&self, load: &Load) -> ForceBalance {
        let per_kg = 1.0 / (load.mass_kg + load.rotating_kg);
        let weight = load.mass_kg * GRAVITY * per_kg;
        ForceBalance {
            traction: load.traction_n * per_kg,
            drag: self.drag_area_m2 * load.air_density * per_kg,
            rolling: weight * self.rolling_resistance,
            gravity: weight * 0.01,
        }
    }
}
