//! A drag area that the parameter does not have.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// F = ½ ρ a v².
pub static EFFECT: Effect = Effect {
    number: 2,
    name: "air_drag",
    unit: "m²",
    typical: 0.6,
    range: Bounds::new(-20.0, 30.0, "-20 to 30 m²"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, _| sample.forces.drag_n(1.0, sample.end.speed_mps)),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "The drag area is larger by the amount: another trailer or load, or a parameter that is wrong.",
    source: "thesis eq. 5",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: true,
    separated_by: "drives at other speeds: air resistance is proportional to the square of the speed",
};
