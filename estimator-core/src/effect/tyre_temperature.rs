//! Tyres that roll harder in cold air.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// Air temperature that coefficients of rolling resistance refer to, °C (ISO 28580).
const REFERENCE_CELSIUS: f32 = 25.0;

/// F = a c_r m g (25 °C − T), T the air temperature as last reported.
pub static EFFECT: Effect = Effect {
    number: 12,
    name: "tyre_temperature",
    unit: "1/K",
    typical: 0.006,
    range: Bounds::new(-0.05, 0.1, "-0.05 to 0.1 a kelvin"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|vehicle, sample, _| {
        let Some(celsius) = sample.effect_inputs.ambient_celsius.get() else {
            return 0.0;
        };
        vehicle.rolling_resistance * sample.forces.weight_n() * (REFERENCE_CELSIUS - celsius)
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Each kelvin that the air is colder than 25 °C adds the amount of the rolling resistance; where no temperature is known, nothing.",
    source: "ISO 28580 corrects to 25 °C with 0.006 a kelvin for large truck tyres, 0.008 for cars; Hyttinen et al. 2022 find more in the cold",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::AmountOverTemperatures {
        smallest_range_k: 3.0,
    },
    is_base_parameter: false,
    separated_by: "drives at other air temperatures, with tyres that are warm",
};
