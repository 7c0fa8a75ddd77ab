//! Classes of vehicles: what is usual where nothing is measured.

use super::estimate::Estimate;
use crate::files::vehicle::VehicleFile;
use estimator_core::Traction;
use serde::Deserialize;
use std::collections::BTreeMap;

const CLASSES: &str = include_str!("classes.toml");

/// Sigmas of the values of another vehicle file, relative: a vehicle like it.
mod like_file {
    pub const MASS: f64 = 0.3;
    pub const DRAG_AREA: f64 = 0.1;
    pub const ROLLING: f64 = 0.15;
    pub const RADIUS: f64 = 0.03;
    pub const INERTIA: f64 = 0.3;
    pub const TORQUE: f64 = 0.1;
    pub const FINAL_DRIVE: f64 = 0.2;
    pub const EFFICIENCY: f64 = 0.01;
}

/// Usual values of a class of vehicles, with their sigmas.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Usual {
    /// Mass of the whole combination, kg.
    pub mass_kg: Estimate,
    /// Drag coefficient times frontal area, m².
    pub drag_area_m2: Estimate,
    /// Rolling resistance coefficient.
    pub rolling_resistance: Estimate,
    /// Effective radius of the driven wheels, m.
    pub wheel_radius_m: Estimate,
    /// Moment of inertia of all wheels, kg m².
    pub wheel_inertia_kgm2: Estimate,
    /// Moment of inertia of the engine, kg m².
    pub engine_inertia_kgm2: Estimate,
    /// Torque that 100 % stands for, Nm.
    pub reference_torque_nm: Estimate,
    /// Ratio of the final drive.
    pub final_drive_ratio: Estimate,
    /// Efficiency of the final drive.
    pub final_drive_efficiency: Estimate,
    /// Efficiency of a gear.
    pub gear_efficiency: Estimate,
}

#[derive(Debug, Deserialize)]
struct ClassTable {
    about: String,
    #[serde(flatten)]
    usual: BTreeMap<String, toml::Value>,
}

/// A class of vehicles.
#[derive(Clone, Debug)]
pub struct Class {
    /// Name, as `--like` takes it.
    pub name: String,
    /// One line about it.
    pub about: String,
    /// What is usual.
    pub usual: Usual,
}

/// Returns all classes, sorted by name.
///
/// # Panics
/// Never: a test reads the table.
#[must_use]
pub fn all() -> Vec<Class> {
    let tables: BTreeMap<String, ClassTable> =
        toml::from_str(CLASSES).expect("the table of classes is tested");
    let class = |(name, table): (String, ClassTable)| {
        let values: toml::Table = table.usual.into_iter().collect();
        Class {
            name,
            about: table.about,
            usual: values.try_into().expect("the table of classes is tested"),
        }
    };
    tables.into_iter().map(class).collect()
}

/// Returns the class with this name.
#[must_use]
pub fn named(name: &str) -> Option<Class> {
    all().into_iter().find(|class| class.name == name)
}

/// Returns the class of vehicles of this mass. `is_bus` tells that the vehicle carries passengers.
///
/// # Panics
/// Never: a test asks for each class.
#[must_use]
pub fn of_mass(mass_kg: f64, is_bus: bool) -> Class {
    let name = match mass_kg {
        m if is_bus && m > 6_000.0 => "bus",
        m if m > 24_000.0 => "truck40t",
        m if m > 6_500.0 => "truck12t",
        m if m > 2_400.0 => "van",
        _ => "car",
    };
    named(name).expect("each of these names is in the table")
}

impl Usual {
    /// Returns the values of a vehicle file as what is usual.
    #[must_use]
    pub fn of_vehicle(file: &VehicleFile, rest: &Self) -> Self {
        let vehicle = &file.model.vehicle;
        let like = |value: f32, relative: f64| {
            let value = f64::from(value);
            Estimate {
                value,
                sigma: value * relative,
            }
        };
        let mut usual = Self {
            mass_kg: like(vehicle.mass_kg, like_file::MASS),
            drag_area_m2: like(vehicle.drag_area_m2, like_file::DRAG_AREA),
            rolling_resistance: like(vehicle.rolling_resistance, like_file::ROLLING),
            wheel_radius_m: like(vehicle.wheel_radius_m, like_file::RADIUS),
            wheel_inertia_kgm2: like(vehicle.wheel_inertia_kgm2, like_file::INERTIA),
            ..*rest
        };
        if let Traction::Powertrain(powertrain) = &vehicle.traction {
            usual.engine_inertia_kgm2 = like(powertrain.engine_inertia_kgm2, like_file::INERTIA);
            usual.reference_torque_nm = like(powertrain.reference_torque_nm, like_file::TORQUE);
            usual.final_drive_ratio = like(powertrain.final_drive_ratio, like_file::FINAL_DRIVE);
            usual.final_drive_efficiency =
                like(powertrain.final_drive_efficiency, like_file::EFFICIENCY);
            if let Some(gear) = powertrain.gears.first() {
                usual.gear_efficiency = like(gear.efficiency, like_file::EFFICIENCY);
            }
        }
        usual
    }
}
