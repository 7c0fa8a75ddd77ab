//! Another mass than the model takes.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// m → m (1 + a). Without it the road reads as steeper by a of all that the mass takes: what is
/// left of traction after air resistance.
pub static EFFECT: Effect = Effect {
    number: 7,
    name: "mass",
    unit: "1",
    typical: 0.1,
    range: Bounds::new(-0.6, 3.0, "-0.6 to 3"),
    parameters: &[],
    acts: Acts::Mass,
    physics: Physics::PerUnit(|vehicle, sample, _| {
        sample.forces.traction_n - vehicle.drag_n(&sample.forces, sample.end.speed_mps)
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "The vehicle is heavier by this part of the mass that the parameter or the bus reports.",
    source: "thesis eq. 9",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: true,
    separated_by: "coasting and acceleration: mass acts in both, torque in neither or only one",
};
