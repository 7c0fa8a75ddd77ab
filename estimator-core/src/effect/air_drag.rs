//! A drag area that the parameter does not have.

use super::{Acts, Bounds, Effect, Physics, drag_n};

/// F = ½ ρ a v².
pub static EFFECT: Effect = Effect {
    name: "air_drag",
    unit: "m²",
    about: "The drag area is larger by the amount: another trailer or load, or a parameter that is wrong.",
    source: "thesis eq. 5",
    typical: 0.6,
    range: Bounds::new(-20.0, 30.0, "-20 to 30 m²"),
    details: &[],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, _| drag_n(1.0, sample, sample.place.speed_mps)),
};
