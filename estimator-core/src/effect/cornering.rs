//! Tyres that run at an angle in a bend.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};
use crate::vehicle::GRAVITY;

/// F = a m g (v ψ' / g)²: the side force over the cornering stiffness is the slip angle, and the
/// side force has a part along the road of as much.
pub static EFFECT: Effect = Effect {
    number: 4,
    name: "cornering",
    unit: "rad",
    typical: 0.2,
    range: Bounds::new(-1.0, 5.0, "-1 to 5 rad"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, _| {
        let Some(yaw_rate_radps) = sample.effect_inputs.yaw_rate_radps.get() else {
            return 0.0;
        };
        let sideways = sample.end.speed_mps * yaw_rate_radps / GRAVITY;
        sample.forces.weight_n() * sideways * sideways
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "In a bend tyres slip sideways; the amount is the angle for a side force as large as the weight (one over the cornering stiffness).",
    source: "linear tyre, stiffness 5.5 a radian; bogies that scrub have more: TRL report SR 484",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: false,
    separated_by: "straight roads",
};
