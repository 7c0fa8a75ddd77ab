//! What an identification finds.

use super::delays::FoundDelay;
use super::estimate::Unknown;
use crate::files::vehicle::VehicleFile;
use serde::Serialize;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// The bus tells it.
    Read,
    /// It follows from the drives.
    Measured,
    /// It is usual for the class of vehicle.
    Assumed,
}

/// One value of the vehicle file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IdentifiedValue {
    /// Key in the vehicle file, with its table: `vehicle.mass_kg`, `powertrain.gears[3].ratio`.
    pub key: String,
    /// The value.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
    /// Where it comes from.
    pub origin: Origin,
    /// How, in a few words.
    #[serde(skip)]
    pub how: String,
}

/// The result of an identification.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The vehicle.
    pub vehicle: VehicleFile,
    /// The class whose usual values fill the gaps.
    pub class: String,
    /// Every value of the vehicle file.
    pub values: Vec<IdentifiedValue>,
    /// How late signals are, where the drives show it.
    pub delays: Vec<FoundDelay>,
    /// What remains unknown.
    pub unknown: Vec<Unknown>,
    /// Why logs were left out, a line each.
    pub left_out: Vec<String>,
}
