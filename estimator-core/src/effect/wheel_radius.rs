//! Wheels that are larger than the parameter, and the bus's own figure, say.

use super::definition::{Acts, Bounds, Description, Effect, Physics, Search, Varies};
use crate::vehicle::Traction;

/// r → r (1 + a): speed and distance → × (1 + a), the force of a torque → ÷ (1 + a). The force
/// here is that at steady speed; most of the effect is in the distance, which GNSS speed shows.
pub static EFFECT: Effect = Effect {
    number: 9,
    name: "wheel_radius",
    unit: "1",
    typical: 0.01,
    range: Bounds::new(-0.2, 0.2, "-0.2 to 0.2"),
    parameters: &[],
    acts: Acts::WheelRadius,
    physics: Physics::Of(|vehicle, sample, _, amount| {
        let lost_n = match vehicle.traction {
            Traction::Powertrain(_) => sample.forces.traction_n * amount / (1.0 + amount),
            Traction::Force => 0.0,
        };
        lost_n + vehicle.drag_n(&sample.forces, sample.end.speed_mps) * amount * (2.0 + amount)
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "The wheels roll further by this part: speed and distance are larger than reported, and a torque gives less force.",
    source: "thesis eq. 9; new and worn tyres differ by 0.02 to 0.03",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::GnssSpeed,
    is_base_parameter: false,
    separated_by: "GNSS speed",
};
