//! `vehicle.toml`: read, checked, written.

mod effects;

use super::kind::{self, Kind};
use super::limits::read_text;
use super::output::write_whole;
use crate::error::{Error, Result};
use estimator_core::{Gear, Model, ParameterError, Powertrain, Traction, VehicleParameters};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A vehicle model with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleFile {
    /// Name in tables.
    pub name: String,
    /// Parameters and effects for the estimator.
    pub model: Model,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleDocument {
    vehicle: VehicleTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    powertrain: Option<PowertrainTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    traction: Option<TractionTable>,
    #[serde(default, skip_serializing_if = "effects::Tables::is_empty")]
    effects: effects::Tables,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleTable {
    name: String,
    mass_kg: f32,
    drag_area_m2: f32,
    rolling_resistance: f32,
    wheel_radius_m: f32,
    wheel_inertia_kgm2: f32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PowertrainTable {
    engine_inertia_kgm2: f32,
    reference_torque_nm: f32,
    final_drive_ratio: f32,
    final_drive_efficiency: f32,
    gears: Vec<GearTable>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct GearTable {
    ratio: f32,
    efficiency: f32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TractionTable {
    source: TractionSource,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum TractionSource {
    Force,
}

impl VehicleFile {
    /// Reads and checks a vehicle file.
    ///
    /// # Errors
    /// Returns an error that names each unknown key, missing key and value out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        Self::checked(toml::from_str(&text), path)
            .map_err(|e| kind::explained(e, path, &[Kind::Vehicle]))
    }

    /// Creates the vehicle from the tables of such a file; `path` is for error messages.
    ///
    /// # Errors
    /// Returns the errors of [`read`](Self::read).
    pub fn from_table(table: toml::Table, path: &Path) -> Result<Self> {
        Self::checked(table.try_into(), path)
    }

    fn checked(
        document: std::result::Result<VehicleDocument, toml::de::Error>,
        path: &Path,
    ) -> Result<Self> {
        let key = |problem: String| Error::Key {
            path: path.to_owned(),
            problem,
        };
        let document = document.map_err(|e| key(e.to_string().trim_end().to_owned()))?;
        let model = document.model().map_err(key)?;
        model
            .check()
            .map_err(|e: ParameterError| key(e.to_string()))?;
        Ok(Self {
            name: document.vehicle.name,
            model,
        })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = self.to_toml();
        write_whole(path, |out| out.write_all(text.as_bytes()))
    }

    /// Returns the text of the file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let p = &self.model.vehicle;
        let (powertrain, traction) = match &p.traction {
            Traction::Powertrain(p) => (Some(PowertrainTable::from(p)), None),
            Traction::Force => (
                None,
                Some(TractionTable {
                    source: TractionSource::Force,
                }),
            ),
        };
        let document = VehicleDocument {
            vehicle: VehicleTable {
                name: self.name.clone(),
                mass_kg: p.mass_kg,
                drag_area_m2: p.drag_area_m2,
                rolling_resistance: p.rolling_resistance,
                wheel_radius_m: p.wheel_radius_m,
                wheel_inertia_kgm2: p.wheel_inertia_kgm2,
            },
            powertrain,
            traction,
            effects: effects::to_tables(&self.model.effects),
        };
        toml::to_string(&document).expect("plain numbers and strings are TOML")
    }
}

impl From<&Powertrain> for PowertrainTable {
    fn from(p: &Powertrain) -> Self {
        Self {
            engine_inertia_kgm2: p.engine_inertia_kgm2,
            reference_torque_nm: p.reference_torque_nm,
            final_drive_ratio: p.final_drive_ratio,
            final_drive_efficiency: p.final_drive_efficiency,
            gears: p
                .gears
                .iter()
                .map(|g| GearTable {
                    ratio: g.ratio,
                    efficiency: g.efficiency,
                })
                .collect(),
        }
    }
}

impl VehicleDocument {
    fn model(&self) -> std::result::Result<Model, String> {
        let traction = match (&self.powertrain, &self.traction) {
            (Some(p), None) => {
                let mut gears = heapless::Vec::new();
                for gear in &p.gears {
                    gears
                        .push(Gear {
                            ratio: gear.ratio,
                            efficiency: gear.efficiency,
                        })
                        .map_err(|_| {
                            format!("powertrain.gears: more than {} gears", gears.capacity())
                        })?;
                }
                Traction::Powertrain(Powertrain {
                    engine_inertia_kgm2: p.engine_inertia_kgm2,
                    reference_torque_nm: p.reference_torque_nm,
                    final_drive_ratio: p.final_drive_ratio,
                    final_drive_efficiency: p.final_drive_efficiency,
                    gears,
                })
            }
            (
                None,
                Some(TractionTable {
                    source: TractionSource::Force,
                }),
            ) => Traction::Force,
            (Some(_), Some(_)) => {
                return Err(
                    "both [powertrain] and [traction] are given; expected one of them".to_owned(),
                );
            }
            (None, None) => {
                return Err(
                    "missing [powertrain] (engine and gearbox), or [traction] source = \"force\""
                        .to_owned(),
                );
            }
        };
        Ok(Model {
            vehicle: VehicleParameters {
                mass_kg: self.vehicle.mass_kg,
                drag_area_m2: self.vehicle.drag_area_m2,
                rolling_resistance: self.vehicle.rolling_resistance,
                wheel_radius_m: self.vehicle.wheel_radius_m,
                wheel_inertia_kgm2: self.vehicle.wheel_inertia_kgm2,
                traction,
            },
            effects: effects::from_tables(&self.effects)?,
        })
    }
}
