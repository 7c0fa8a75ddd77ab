//! Wind along the road.

use super::definition::{
    Acts, Bounds, Description, Effect, EffectParameter, Physics, Search, Varies,
};
use crate::angle::cos_deg;
use crate::maybe::Maybe;

/// F = ½ ρ cd A ((v + w)² − v²), w the wind from ahead.
pub static EFFECT: Effect = Effect {
    number: 3,
    name: "headwind",
    unit: "m/s",
    typical: 3.0,
    range: Bounds::new(-40.0, 40.0, "-40 to 40 m/s"),
    parameters: &[EffectParameter {
        key: "from_deg",
        about: "where the wind blows from, clockwise from north, °; absent: always from ahead",
        default: Maybe::NONE,
        range: Bounds::new(0.0, 360.0, "0 to 360°"),
    }],
    acts: Acts::Resists,
    physics: Physics::Of(|vehicle, sample, parameters, amount| {
        let ahead = match (parameters[0].get(), sample.effect_inputs.course_deg.get()) {
            (None, _) => 1.0,
            (Some(from_deg), Some(course_deg)) => cos_deg(course_deg - from_deg),
            (Some(_), None) => return 0.0,
        };
        let air_mps = sample.end.speed_mps + amount * ahead;
        sample.forces.drag_n(vehicle.drag_area_m2, air_mps)
            - vehicle.drag_n(&sample.forces, sample.end.speed_mps)
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "Wind of this speed adds to the air that meets the vehicle: from ahead it resists, from behind it pushes.",
    source: "thesis eq. 5 with the air's own speed",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::NorthAndEast { key: "from_deg" },
    is_base_parameter: false,
    separated_by: "drives both ways, or on other days: wind turns with the course",
};
