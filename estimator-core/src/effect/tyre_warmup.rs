//! Tyres that are cold where a drive begins.

use super::definition::{
    Acts, Bounds, Description, Effect, EffectParameter, Physics, Search, Varies,
};
use crate::maybe::Maybe;

/// F = a c_r m g exp(−t/τ), t the time in motion.
pub static EFFECT: Effect = Effect {
    number: 1,
    name: "tyre_warmup",
    unit: "1",
    typical: 0.5,
    range: Bounds::new(-1.0, 5.0, "-1 to 5"),
    parameters: &[EffectParameter {
        key: "time_s",
        about: "time in motion in which all but 1/e of it is gone, s",
        default: Maybe::some(1_500.0),
        range: Bounds::new(30.0, 20_000.0, "30 to 20000 s"),
    }],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|vehicle, sample, parameters| {
        let Some(time_s) = parameters[0].get() else {
            return 0.0;
        };
        let left = libm::expf(-sample.effect_inputs.driven_s / time_s);
        vehicle.rolling_resistance * sample.forces.weight_n() * left
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Cold tyres add the amount of the rolling resistance at the start of a drive, and less as they warm up.",
    source: "thesis section 7.2 (drift of morning drives); Hyttinen et al. 2022; 0.3 to 0.8 of it, over 15 to 40 min",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::AmountForEachDrive {
        key: "time_s",
        values: &[600.0, 1_000.0, 1_700.0, 2_800.0],
    },
    is_base_parameter: false,
    separated_by: "drives that begin warm: tyres are warm after half an hour",
};
