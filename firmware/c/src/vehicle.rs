//! A vehicle as a parameter block.

use crate::status::Status;
use estimator_core::effect::numbered;
use estimator_core::vehicle::MAX_GEARS;
use estimator_core::{AdoptedEffect, Gear, Maybe, Model, Powertrain, Traction, VehicleParameters};

/// Most forward gears of a vehicle.
pub const GRADE_MOST_GEARS: usize = 24;
/// Most effects of a vehicle.
pub const GRADE_MOST_EFFECTS: usize = 16;
/// Value of `gear_count` for a measured traction force: the powertrain is left out.
pub const GRADE_MEASURED_FORCE: u32 = u32::MAX;

const _: () = assert!(GRADE_MOST_GEARS == MAX_GEARS);
const _: () = assert!(GRADE_MOST_EFFECTS >= estimator_core::effect::MAX_EFFECTS);

/// One gear.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct VehicleGear {
    /// Engine turns to one turn of the output shaft.
    pub ratio: f32,
    /// Part of the power that comes through, 0.5 to 1.
    pub efficiency: f32,
}

/// One adopted effect, as a diagnosis wrote it to the vehicle file.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct VehicleEffect {
    /// Its number, which never changes (docs/formats.md).
    pub number: u32,
    /// Its amount, in its unit.
    pub amount: f32,
    /// One standard deviation of the amount.
    pub amount_sigma: f32,
    /// Its parameters; not a number where it has none.
    pub parameters: [f32; 3],
}

/// A vehicle: what docs/formats.md says of a vehicle file.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Vehicle {
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
    /// Moment of inertia of the engine, kg m².
    pub engine_inertia_kgm2: f32,
    /// Torque that 100 % stands for (SPN 544), Nm.
    pub reference_torque_nm: f32,
    /// Output shaft turns to one turn of the wheels.
    pub final_drive_ratio: f32,
    /// Part of the power that comes through the final drive, 0.5 to 1.
    pub final_drive_efficiency: f32,
    /// Number of gears, or `GRADE_MEASURED_FORCE`.
    pub gear_count: u32,
    /// The gears, first gear first.
    pub gears: [VehicleGear; GRADE_MOST_GEARS],
    /// Number of effects.
    pub effect_count: u32,
    /// The effects.
    pub effects: [VehicleEffect; GRADE_MOST_EFFECTS],
}

impl Vehicle {
    /// Returns the model of the vehicle. The estimator checks whether its values are possible.
    pub(crate) fn model(&self) -> Result<Model, Status> {
        let mut model = Model::from(VehicleParameters {
            mass_kg: self.mass_kg,
            drag_area_m2: self.drag_area_m2,
            rolling_resistance: self.rolling_resistance,
            wheel_radius_m: self.wheel_radius_m,
            wheel_inertia_kgm2: self.wheel_inertia_kgm2,
            traction: self.traction()?,
        });
        let effects = self.effects.get(..self.effect_count as usize);
        for effect in effects.ok_or(Status::Vehicle)? {
            let adopted = AdoptedEffect {
                effect: numbered(effect.number).ok_or(Status::Vehicle)?,
                amount: effect.amount,
                amount_sigma: effect.amount_sigma,
                parameters: effect.parameters.map(Maybe::some),
            };
            let is_known = |known: &AdoptedEffect| known.effect == adopted.effect;
            if model.effects.iter().any(is_known) || model.effects.adopt(adopted).is_err() {
                return Err(Status::Vehicle);
            }
        }
        Ok(model)
    }

    fn traction(&self) -> Result<Traction, Status> {
        if self.gear_count == GRADE_MEASURED_FORCE {
            return Ok(Traction::Force);
        }
        let gears = self.gears.get(..self.gear_count as usize);
        let gears = gears.ok_or(Status::Vehicle)?.iter();
        Ok(Traction::Powertrain(Powertrain {
            engine_inertia_kgm2: self.engine_inertia_kgm2,
            reference_torque_nm: self.reference_torque_nm,
            final_drive_ratio: self.final_drive_ratio,
            final_drive_efficiency: self.final_drive_efficiency,
            gears: gears
                .map(|gear| Gear {
                    ratio: gear.ratio,
                    efficiency: gear.efficiency,
                })
                .collect(),
        }))
    }
}
