//! Tyres that are cold where a drive begins.

use super::{Acts, Bounds, Detail, Effect, Physics, weight_n};
use crate::maybe::Maybe;

/// F = a c_r m g exp(−t/τ), t the time in motion.
pub static EFFECT: Effect = Effect {
    name: "tyre_warmup",
    unit: "1",
    about: "Cold tyres add the amount of the rolling resistance at the start of a drive, and less as they warm up.",
    source: "thesis section 7.2 (drift of morning drives); Hyttinen et al. 2022; 0.3 to 0.8 of it, over 15 to 40 min",
    typical: 0.5,
    range: Bounds::new(-1.0, 5.0, "-1 to 5"),
    details: &[Detail {
        key: "time_s",
        about: "time in motion in which all but 1/e of it is gone, s",
        default: Maybe::some(1_500.0),
        range: Bounds::new(30.0, 20_000.0, "30 to 20000 s"),
    }],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|vehicle, sample, details| {
        let Some(time_s) = details[0].get() else {
            return 0.0;
        };
        let left = libm::expf(-sample.circumstances.driven_s / time_s);
        vehicle.rolling_resistance * weight_n(sample) * left
    }),
};
