//! Air, wind and cold tyres in the scenario file.

use serde::Deserialize;

/// Specific gas constant of dry air, J/(kg K).
const GAS_CONSTANT: f64 = 287.05;

/// `[air]`: the true values, which the bus reports too.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Air {
    /// Air pressure, Pa, 50 000 to 110 000, default 101 000.
    pub pressure_pa: f64,
    /// Air temperature, °C, -60 to 60, default 20.
    pub temperature_celsius: f64,
}

impl Air {
    /// Returns the density of dry air, kg/m³.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.pressure_pa / (GAS_CONSTANT * (self.temperature_celsius + 273.15))
    }
}

impl Default for Air {
    fn default() -> Self {
        Self {
            pressure_pa: 101_000.0,
            temperature_celsius: 20.0,
        }
    }
}

/// `[wind]`. No signal reports the wind.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    /// Speed of the steady wind, m/s, 0 to 40, default 0.
    pub speed_mps: f64,
    /// Direction that the steady wind comes from, deg clockwise from north, 0 to 360, default 270.
    pub from_deg: f64,
    /// Gusts along the road, 1 sigma, m/s, 0 to 20, default 0.
    pub gust_sigma_mps: f64,
    /// Correlation time of the gusts, s, 0.1 to 1e6, default 60.
    pub gust_time_s: f64,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            speed_mps: 0.0,
            from_deg: 270.0,
            gust_sigma_mps: 0.0,
            gust_time_s: 60.0,
        }
    }
}

/// `wind` of `[[runs]]`: another steady wind.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWind {
    /// Speed, m/s, 0 to 40.
    pub speed_mps: f64,
    /// Direction that the wind comes from, deg clockwise from north, 0 to 360.
    pub from_deg: f64,
}

/// `[tyres]`: cold at the start of each run, unless the run has already driven.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tyres {
    /// Additional rolling resistance at the start, as a part of that of warm tyres, 0 to 5, default
    /// 0.
    pub cold_amount: f64,
    /// Time constant of the warming, s, 1 to 1e6, default 1500.
    pub cold_time_s: f64,
}

impl Default for Tyres {
    fn default() -> Self {
        Self {
            cold_amount: 0.0,
            cold_time_s: 1_500.0,
        }
    }
}
