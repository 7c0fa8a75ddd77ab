//! The vehicle while it is identified: a value and an origin for each parameter.

use super::class::Usual;
use super::estimate::Estimate;
use super::gears::FoundGear;
use super::identified::Origin;
use super::observation::Observation;
use estimator_core::{Gear, Model, Powertrain, Signal, Traction, VehicleParameters};

/// Relative sigma of a value that the bus tells.
const READ: f64 = 0.005;
/// Range of reference torques that engines have, Nm. Others are no measurement.
const TORQUES_NM: std::ops::RangeInclusive<f64> = 50.0..=10_000.0;

/// A parameter, and where it comes from.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its value.
    pub estimate: Estimate,
    /// Its origin.
    pub origin: Origin,
    /// How, in a few words.
    pub how: String,
}

impl Parameter {
    /// Creates a parameter that is usual for a class.
    #[must_use]
    pub fn assumed(estimate: Estimate, class: &str) -> Self {
        Self {
            estimate,
            origin: Origin::Assumed,
            how: format!("usual for {class}"),
        }
    }

    /// Creates a parameter that the bus tells.
    #[must_use]
    pub fn read(value: f64, how: &str) -> Self {
        Self {
            estimate: Estimate::new(value, READ * value),
            origin: Origin::Read,
            how: how.to_owned(),
        }
    }

    /// Creates a measured parameter.
    #[must_use]
    pub fn measured(estimate: Estimate, how: impl Into<String>) -> Self {
        Self {
            estimate,
            origin: Origin::Measured,
            how: how.into(),
        }
    }

    /// Returns the value.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.estimate.value
    }
}

/// The driveline.
#[derive(Clone, Debug)]
pub struct DraftDriveline {
    /// Moment of inertia of the engine, kg m².
    pub engine_inertia_kgm2: Parameter,
    /// Torque that 100 % stands for, Nm.
    pub reference_torque_nm: Parameter,
    /// Ratio of the final drive, with the assumed wheel radius.
    pub final_drive_ratio: Parameter,
    /// Efficiency of the final drive.
    pub final_drive_efficiency: Parameter,
    /// Efficiency of each gear.
    pub gear_efficiency: Parameter,
    /// Gear ratios, first gear first.
    pub gear_ratios: Vec<Parameter>,
}

/// The vehicle.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Mass, kg.
    pub mass_kg: Parameter,
    /// Drag area, m².
    pub drag_area_m2: Parameter,
    /// Coefficient of rolling resistance.
    pub rolling_resistance: Parameter,
    /// Wheel radius, m.
    pub wheel_radius_m: Parameter,
    /// Moment of inertia of all wheels, kg m².
    pub wheel_inertia_kgm2: Parameter,
    /// The driveline; `None` for a measured traction force.
    pub driveline: Option<DraftDriveline>,
}

impl Draft {
    /// Creates the vehicle of a class with what the bus tells. `gears` is empty for a vehicle with
    /// measured traction force.
    #[must_use]
    pub fn new(usual: &Usual, class: &str, observation: &Observation, gears: &[FoundGear]) -> Self {
        let assumed = |estimate| Parameter::assumed(estimate, class);
        let mass_kg = match observation.told(Signal::Mass) {
            Some((mean, scatter)) => {
                let mut mass = Parameter::read(mean, "mean of the mass on the bus");
                mass.estimate.sigma = mass.estimate.sigma.hypot(scatter);
                mass
            }
            None => assumed(usual.mass_kg),
        };
        let driveline = (!gears.is_empty()).then(|| driveline(usual, class, observation, gears));
        Self {
            mass_kg,
            drag_area_m2: assumed(usual.drag_area_m2),
            rolling_resistance: assumed(usual.rolling_resistance),
            wheel_radius_m: assumed(usual.wheel_radius_m),
            wheel_inertia_kgm2: assumed(usual.wheel_inertia_kgm2),
            driveline,
        }
    }

    /// Returns the model for the estimator.
    #[must_use]
    pub fn model(&self) -> Model {
        let value = |parameter: &Parameter| significant(parameter.value());
        let traction = self.driveline.as_ref().map_or(Traction::Force, |of| {
            let gear = |ratio: &Parameter| Gear {
                ratio: value(ratio),
                efficiency: value(&of.gear_efficiency),
            };
            Traction::Powertrain(Powertrain {
                engine_inertia_kgm2: value(&of.engine_inertia_kgm2),
                reference_torque_nm: value(&of.reference_torque_nm),
                final_drive_ratio: value(&of.final_drive_ratio),
                final_drive_efficiency: value(&of.final_drive_efficiency),
                gears: of.gear_ratios.iter().map(gear).collect(),
            })
        });
        Model::from(VehicleParameters {
            mass_kg: value(&self.mass_kg),
            drag_area_m2: value(&self.drag_area_m2),
            rolling_resistance: value(&self.rolling_resistance),
            wheel_radius_m: value(&self.wheel_radius_m),
            wheel_inertia_kgm2: value(&self.wheel_inertia_kgm2),
            traction,
        })
    }
}

/// Rounds to five significant digits, as a vehicle file shows them.
fn significant(value: f64) -> f32 {
    format!("{value:.4e}").parse().unwrap_or(value as f32)
}

fn driveline(
    usual: &Usual,
    class: &str,
    observation: &Observation,
    gears: &[FoundGear],
) -> DraftDriveline {
    let assumed = |estimate| Parameter::assumed(estimate, class);
    let told = |signal, usual: Estimate, range: std::ops::RangeInclusive<f64>, how| {
        observation
            .told(signal)
            .filter(|(mean, _)| range.contains(mean))
            .map_or_else(|| assumed(usual), |(mean, _)| Parameter::read(mean, how))
    };
    let reference_torque_nm = if observation.has_torque_in_nm() {
        let mut unused = assumed(usual.reference_torque_nm);
        unused.origin = Origin::Read;
        unused.how = "torque comes in Nm: not used".to_owned();
        unused
    } else {
        told(
            Signal::EngineReferenceTorque,
            usual.reference_torque_nm,
            TORQUES_NM,
            "EC1, SPN 544, or MG1IR1, SPN 10170",
        )
    };
    let final_drive_ratio = final_drive(usual, gears).unwrap_or_else(|| {
        let mut of_class = assumed(usual.final_drive_ratio);
        of_class.how += "; only its product with the gear ratios matters";
        of_class
    });
    let per_turn = usual.wheel_radius_m.value / final_drive_ratio.value();
    let gear_ratios = gears.iter().map(|gear| gear_ratio(gear, per_turn));
    DraftDriveline {
        engine_inertia_kgm2: told(
            Signal::EngineInertia,
            usual.engine_inertia_kgm2,
            0.01..=50.0,
            "EC1, SPN 1794",
        ),
        reference_torque_nm,
        final_drive_efficiency: assumed(usual.final_drive_efficiency),
        gear_efficiency: assumed(usual.gear_efficiency),
        gear_ratios: gear_ratios.collect(),
        final_drive_ratio,
    }
}

/// Returns the final drive from the gears whose ratio the bus reports: engine turns to a metre, over
/// that ratio.
fn final_drive(usual: &Usual, gears: &[FoundGear]) -> Option<Parameter> {
    let radius_m = usual.wheel_radius_m.value;
    let (mut sum, mut weights) = (0.0, 0.0);
    for gear in gears {
        if let Some(reported) = gear.reported.filter(|_| gear.origin == Origin::Measured) {
            let weight = gear.turns_per_m.relative_sigma().powi(-2);
            sum += weight * gear.turns_per_m.value * radius_m / reported;
            weights += weight;
        }
    }
    (weights > 0.0).then(|| {
        let value = sum / weights;
        // Errors of speeds are common to all gears: more of them do not average out.
        let best = gears.iter().filter(|gear| gear.reported.is_some());
        let relative = best
            .map(|gear| gear.turns_per_m.relative_sigma())
            .fold(f64::INFINITY, f64::min);
        let how = format!("engine speed over wheel speed, for a wheel radius of {radius_m} m");
        Parameter::measured(Estimate::new(value, value * relative), how)
    })
}

fn gear_ratio(gear: &FoundGear, per_turn: f64) -> Parameter {
    match (gear.reported, gear.origin) {
        (Some(ratio), _) => Parameter::read(ratio, "SPN 526"),
        (None, Origin::Assumed) => Parameter {
            estimate: scaled(gear.turns_per_m, per_turn),
            origin: Origin::Assumed,
            how: "not driven: from its neighbours".to_owned(),
        },
        (None, _) => Parameter::measured(
            scaled(gear.turns_per_m, per_turn),
            "engine speed over wheel speed",
        ),
    }
}

fn scaled(estimate: Estimate, factor: f64) -> Estimate {
    Estimate::new(estimate.value * factor, estimate.sigma * factor)
}
