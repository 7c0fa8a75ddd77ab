//! Resistance: air and rolling (thesis eq. 5 and 6).

/// Density where neither pressure nor temperature is known, kg/m³.
pub const STANDARD_AIR_DENSITY: f32 = 1.2;

/// Specific gas constant of dry air, J/(kg K).
const GAS_CONSTANT: f32 = 287.05;

/// Density of dry air, kg/m³; the standard one where a value is missing or not of this earth.
#[must_use]
pub fn air_density(pressure_pa: Option<f32>, ambient_celsius: Option<f32>) -> f32 {
    match (pressure_pa, ambient_celsius) {
        (Some(pressure), Some(celsius))
            if (50_000.0..=110_000.0).contains(&pressure) && (-60.0..=60.0).contains(&celsius) =>
        {
            pressure / (GAS_CONSTANT * (celsius + 273.15))
        }
        _ => STANDARD_AIR_DENSITY,
    }
}
