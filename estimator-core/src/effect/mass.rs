//! Another mass than the model takes.

use super::{Acts, Bounds, Effect, Physics, base_drag_n};

/// m → m (1 + a). Without it the road reads as steeper by a of all that the mass takes: what is
/// left of traction after air resistance.
pub static EFFECT: Effect = Effect {
    name: "mass",
    unit: "1",
    about: "The vehicle is heavier by this part of the mass that the parameter or the bus tells.",
    source: "thesis eq. 9",
    typical: 0.1,
    range: Bounds::new(-0.6, 3.0, "-0.6 to 3"),
    details: &[],
    acts: Acts::Mass,
    physics: Physics::PerUnit(|vehicle, sample, _| {
        sample.load.traction_n - base_drag_n(vehicle, sample)
    }),
};
