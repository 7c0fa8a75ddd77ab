//! The vehicle model: parameters together with the adopted effects.

mod adopted_effects;

pub use adopted_effects::{AdoptedEffect, AdoptedEffects};

use crate::effect::Acts;
use crate::vehicle::{Driveline, ParameterError, VehicleParameters};

/// The model of one vehicle: its parameters (thesis eq. 1 to 9), and what the base model lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The parameters as given.
    pub vehicle: VehicleParameters,
    /// The adopted effects.
    pub effects: AdoptedEffects,
}

impl From<VehicleParameters> for Model {
    /// Creates the base model, without effects.
    fn from(vehicle: VehicleParameters) -> Self {
        Self {
            vehicle,
            effects: AdoptedEffects::default(),
        }
    }
}

impl Model {
    /// Checks every parameter, amount and parameter of an effect.
    ///
    /// # Errors
    /// The first one that no vehicle can have.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.vehicle.check()?;
        self.effects.check()
    }

    /// Returns the radius that the driven wheels are believed to have, m.
    #[must_use]
    pub fn wheel_radius_m(&self) -> f32 {
        self.vehicle.wheel_radius_m * self.effects.factor(Acts::WheelRadius)
    }

    /// Returns [`VehicleParameters::traction_n`] with the believed wheel radius, N.
    #[must_use]
    pub fn traction_n(&self, driveline: Driveline, net_torque_percent: f32) -> f32 {
        let radius_m = self.wheel_radius_m();
        self.vehicle
            .traction_n(driveline, net_torque_percent, radius_m)
    }

    /// Returns [`VehicleParameters::rotating_kg`] with the believed wheel radius, kg.
    #[must_use]
    pub fn rotating_kg(&self, driveline: Driveline) -> f32 {
        self.vehicle.rotating_kg(driveline, self.wheel_radius_m())
    }
}
