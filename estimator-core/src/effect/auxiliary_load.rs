//! Power that does not get to the wheels.

use super::definition::{
    Acts, Bounds, Description, Effect, EffectParameter, Physics, Search, Varies,
};
use crate::maybe::Maybe;
use crate::scalar::Scalar;

/// Speed below which the force of a power grows no more, m/s: torque is limited.
const SLOWEST_MPS: f32 = 2.0;

/// F = a / v; with the fan, of it the part at which that runs.
pub static EFFECT: Effect = Effect {
    number: 6,
    name: "auxiliary_load",
    unit: "W",
    typical: 10_000.0,
    range: Bounds::new(-50_000.0, 200_000.0, "-50000 to 200000 W"),
    parameters: &[EffectParameter {
        key: "with_fan",
        about: "1: the power goes with the fan (SPN 975), which takes all of it at full speed; 0: it is always there",
        default: Maybe::some(0.0),
        range: Bounds::new(0.0, 1.0, "0 or 1"),
    }],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, parameters| {
        if !sample.effect_inputs.engaged {
            return 0.0;
        }
        let with_fan = parameters[0].get().is_some_and(|with_fan| with_fan > 0.5);
        let part = match sample.effect_inputs.fan_percent.get() {
            Some(percent) if with_fan => 0.01 * percent,
            None if with_fan => 0.0,
            _ => 1.0,
        };
        part / Scalar::max(SLOWEST_MPS, sample.end.speed_mps)
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Fan, compressor, alternator, steering or cooling take this power from the driveline, all the time or with the fan.",
    source: "VECTO long haul: 4 to 6 kW all in all; a fan engaged takes 15 to 30 kW",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::AmountForEachValue {
        key: "with_fan",
        values: &[0.0, 1.0],
    },
    is_base_parameter: false,
    separated_by: "drives at other speeds, and coasting with an open driveline: the force of a power decreases with speed",
};
