//! What an identification finds.

use super::delays::FoundDelay;
use crate::files::vehicle::VehicleFile;
use serde::{Deserialize, Serialize};

/// A value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// One standard deviation, in the unit of the value.
    pub sigma: f64,
}

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

/// What these logs cannot tell, and the drive that would.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unknown {
    /// What is not known.
    pub what: String,
    /// What to record.
    pub advice: String,
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

impl Estimate {
    /// Returns this value with this sigma.
    #[must_use]
    pub const fn new(value: f64, sigma: f64) -> Self {
        Self { value, sigma }
    }

    /// Returns the sigma as a part of the value.
    #[must_use]
    pub fn relative_sigma(&self) -> f64 {
        self.sigma / self.value
    }
}
