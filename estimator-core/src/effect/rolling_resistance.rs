//! A rolling resistance that the parameter does not have.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// F = a m g.
pub static EFFECT: Effect = Effect {
    number: 0,
    name: "rolling_resistance",
    unit: "1",
    typical: 0.001,
    range: Bounds::new(-0.02, 0.1, "-0.02 to 0.1"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, _| sample.forces.weight_n()),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "The coefficient of rolling resistance is larger by the amount: weather, wet or rough roads, tyres.",
    source: "thesis eq. 6; ISO 28580 (0.6 % of it a kelvin); rough texture 0.001 to 0.0017 a mm of depth",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: true,
    separated_by: "drives with another load: rolling resistance is proportional to the weight, a dragging brake is not",
};
