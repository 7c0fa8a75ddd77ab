//! A torque, or a traction force, that is reported too small or too large.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// Traction → traction (1 + a): F = −a traction.
pub static EFFECT: Effect = Effect {
    number: 8,
    name: "torque_scale",
    unit: "1",
    typical: 0.05,
    range: Bounds::new(-0.5, 1.0, "-0.5 to 1"),
    parameters: &[],
    acts: Acts::Traction,
    physics: Physics::PerUnit(|_, sample, _| -sample.forces.traction_n),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "The true traction force is larger by this part of what the engine or the motor reports, driving and braking.",
    source: "thesis eq. 4; engines report torque within some 5 %",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: true,
    separated_by: "coasting in neutral, where no torque acts, and engine braking",
};
