//! A torque, or a traction force, that is told too small or too large.

use super::{Acts, Bounds, Effect, Physics};

/// Traction → traction (1 + a): F = −a traction.
pub static EFFECT: Effect = Effect {
    name: "torque_scale",
    unit: "1",
    about: "The true traction force is larger by this part of what the engine or the motor tells, driving and braking.",
    source: "thesis eq. 4; engines tell torque within some 5 %",
    typical: 0.05,
    range: Bounds::new(-0.5, 1.0, "-0.5 to 1"),
    details: &[],
    acts: Acts::Traction,
    physics: Physics::PerUnit(|_, sample, _| -sample.load.traction_n),
};
