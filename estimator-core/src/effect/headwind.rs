//! Wind along the road.

use super::{Acts, Bounds, Detail, Effect, Physics, base_drag_n, drag_n};
use crate::angle::cos_deg;
use crate::maybe::Maybe;

/// F = ½ ρ cd A ((v + w)² − v²), w the wind from ahead.
pub static EFFECT: Effect = Effect {
    name: "headwind",
    unit: "m/s",
    about: "Wind of this speed adds to the air that meets the vehicle: from ahead it resists, from behind it pushes.",
    source: "thesis eq. 5 with the air's own speed",
    typical: 3.0,
    range: Bounds::new(-40.0, 40.0, "-40 to 40 m/s"),
    details: &[Detail {
        key: "from_deg",
        about: "where the wind blows from, clockwise from north, °; absent: always from ahead",
        default: Maybe::NONE,
        range: Bounds::new(0.0, 360.0, "0 to 360°"),
    }],
    acts: Acts::Resists,
    physics: Physics::Of(|vehicle, sample, details, amount| {
        let ahead = match (details[0].get(), sample.circumstances.course_deg.get()) {
            (None, _) => 1.0,
            (Some(from_deg), Some(course_deg)) => cos_deg(course_deg - from_deg),
            (Some(_), None) => return 0.0,
        };
        let air_mps = sample.place.speed_mps + amount * ahead;
        drag_n(vehicle.drag_area_m2, sample, air_mps) - base_drag_n(vehicle, sample)
    }),
};
