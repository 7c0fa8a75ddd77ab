//! Each value with its origin, and what the logs cannot tell.

use super::draft::{Draft, Parameter};
use super::estimate::{Estimate, Unknown};
use super::identified::{Identified, IdentifiedValue, Origin};
use super::observation::Observation;
use crate::files::vehicle::VehicleFile;
use estimator_core::AdoptedEffect;
use estimator_core::effect::torque_scale;

/// Few gears: fewer than most gearboxes have.
const FEW_GEARS: usize = 4;

/// What the steps found, for the account.
pub struct Findings<'a> {
    /// What the logs show.
    pub observation: &'a Observation,
    /// Name of the class.
    pub class: &'a str,
    /// The vehicle.
    pub draft: &'a Draft,
    /// Traction over what the torque says, less one.
    pub traction_scale: Option<Estimate>,
}

/// Returns the result of what was found.
#[must_use]
pub fn identified(found: &Findings<'_>) -> Identified {
    let mut model = found.draft.model();
    let mut values = values(found.draft);
    if let Some(Estimate { value, sigma }) = found.traction_scale {
        let effect = AdoptedEffect::new(&torque_scale::EFFECT, value as f32, sigma as f32);
        if model.effects.adopt(effect).is_ok() {
            values.push(IdentifiedValue {
                key: "effects.torque_scale.amount".to_owned(),
                value,
                sigma,
                origin: Origin::Measured,
                how: "traction that the drives need, over what the torque says, less one"
                    .to_owned(),
            });
        }
    }
    Identified {
        vehicle: VehicleFile {
            name: found.class.to_owned(),
            model,
        },
        class: found.class.to_owned(),
        unknown: unknown(found),
        values,
        delays: Vec::new(),
        left_out: Vec::new(),
    }
}

fn values(draft: &Draft) -> Vec<IdentifiedValue> {
    let value = |key: &str, parameter: &Parameter| IdentifiedValue {
        key: key.to_owned(),
        value: parameter.estimate.value,
        sigma: parameter.estimate.sigma,
        origin: parameter.origin,
        how: parameter.how.clone(),
    };
    let mut values = vec![
        value("vehicle.mass_kg", &draft.mass_kg),
        value("vehicle.drag_area_m2", &draft.drag_area_m2),
        value("vehicle.rolling_resistance", &draft.rolling_resistance),
        value("vehicle.wheel_radius_m", &draft.wheel_radius_m),
        value("vehicle.wheel_inertia_kgm2", &draft.wheel_inertia_kgm2),
    ];
    let Some(of) = &draft.driveline else {
        return values;
    };
    values.extend([
        value("powertrain.engine_inertia_kgm2", &of.engine_inertia_kgm2),
        value("powertrain.reference_torque_nm", &of.reference_torque_nm),
        value("powertrain.final_drive_ratio", &of.final_drive_ratio),
        value(
            "powertrain.final_drive_efficiency",
            &of.final_drive_efficiency,
        ),
    ]);
    for (number, ratio) in of.gear_ratios.iter().enumerate() {
        let key = |name: &str| format!("powertrain.gears[{number}].{name}");
        values.push(value(&key("ratio"), ratio));
        values.push(value(&key("efficiency"), &of.gear_efficiency));
    }
    values
}

fn unknown(found: &Findings<'_>) -> Vec<Unknown> {
    let Findings {
        draft, observation, ..
    } = found;
    let mut unknown = Vec::new();
    let mut add = |what: &str, advice: &str| {
        unknown.push(Unknown {
            what: what.to_owned(),
            advice: advice.to_owned(),
        });
    };
    if let Some(driveline) = &draft.driveline {
        let is_driven = |gear: &&Parameter| gear.origin != Origin::Assumed;
        let driven = driveline.gear_ratios.iter().filter(is_driven).count();
        if driven < driveline.gear_ratios.len() || driven < FEW_GEARS {
            add(
                &format!("the ratios of all gears: {driven} gears were driven for long enough"),
                "Record a drive from standstill to full speed, through all gears, without haste.",
            );
        }
        let told = driveline.reference_torque_nm.origin == Origin::Read;
        if !told && draft.mass_kg.origin != Origin::Read {
            add(
                "mass and reference torque apart; the drives show their ratio, which the grade needs",
                "Record EC1 (PGN 65251, sent every 5 s), or weigh the vehicle and give --like a file \
                 with its mass.",
            );
        }
    }
    if draft.drag_area_m2.origin == Origin::Assumed {
        add(
            "drag area",
            "Record a drive at two steady speeds, 50 and 85 km/h, on the same road.",
        );
    }
    if draft.rolling_resistance.origin == Origin::Assumed {
        add(
            "rolling resistance",
            "Record a longer drive, best a round trip to the same place.",
        );
    }
    if draft.wheel_radius_m.origin == Origin::Assumed {
        add(
            "wheel radius",
            if observation.ground.weight() > 0.0 {
                "Record two kilometres at steady speed above 30 km/h."
            } else {
                "Record GNSS speed (NMEA 2000 129026, or VDS)."
            },
        );
    }
    unknown
}
