//! A driveline that loses more than its efficiency says.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};

/// F = a |traction|, driving and driven.
pub static EFFECT: Effect = Effect {
    number: 5,
    name: "driveline_loss",
    unit: "1",
    typical: 0.04,
    range: Bounds::new(-0.3, 0.5, "-0.3 to 0.5"),
    parameters: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, _| {
        if sample.effect_inputs.engaged {
            sample.forces.traction_n.abs()
        } else {
            0.0
        }
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Gearbox, shafts and axle lose this part of the traction force besides the losses that are known, in either direction.",
    source: "thesis eq. 2 to 4; cold oil takes 0.03 to 0.12 (Transport Canada 1994)",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::Amount,
    is_base_parameter: false,
    separated_by: "engine braking and long descents: losses brake there too, a torque scale drives",
};
