//! Brakes that drag.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// F = a while the vehicle moves, as it does in every cell.
pub static EFFECT: Effect = Effect {
    number: 10,
    name: "brake_drag",
    unit: "N",
    typical: 300.0,
    range: Bounds::new(-5_000.0, 20_000.0, "-5000 to 20000 N"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, _, _| 1.0),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Brakes that do not let go, or bearings, resist with a constant force that does not grow with the load.",
    source: "a constant force in thesis eq. 9; its usual size is a guess: 0.1 % of 39 t",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: false,
    separated_by: "drives with another load: rolling resistance is proportional to the weight, a dragging brake is not",
};
