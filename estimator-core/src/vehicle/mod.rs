//! The vehicle: its parameters, its powertrain, and its force balance (thesis eq. 1 to 9).

pub mod force_balance;
pub mod parameter_check;
pub mod parameters;
pub mod powertrain;
mod traction;

pub use force_balance::{ForceBalance, GRAVITY, STANDARD_AIR_DENSITY, air_density};
pub use parameter_check::ParameterError;
pub use parameters::VehicleParameters;
pub use powertrain::{Driveline, Gear, MAX_GEARS, Powertrain, Traction};
