//! A rough stretch of road.

use super::definition::{
    Acts, Bounds, Description, Effect, EffectParameter, Physics, Search, Varies,
};
use crate::angle::cos_deg;
use crate::maybe::Maybe;

/// Metres in a degree of latitude: the meridian of 40,008 km over 360.
const M_PER_DEG: f32 = 111_132.0;

/// F = a m g within half the length around the place. A coordinate that is absent does not count.
pub static EFFECT: Effect = Effect {
    number: 11,
    name: "road_surface",
    unit: "1",
    typical: 0.0015,
    range: Bounds::new(-0.02, 0.1, "-0.02 to 0.1"),
    parameters: &[
        EffectParameter {
            key: "latitude_deg",
            about: "latitude of the middle of the stretch, °; absent: any",
            default: Maybe::NONE,
            range: Bounds::new(-90.0, 90.0, "-90 to 90°"),
        },
        EffectParameter {
            key: "longitude_deg",
            about: "longitude of the middle of the stretch, °; absent: any",
            default: Maybe::NONE,
            range: Bounds::new(-180.0, 180.0, "-180 to 180°"),
        },
        EffectParameter {
            key: "length_m",
            about: "length of the stretch, m",
            default: Maybe::some(1_000.0),
            range: Bounds::new(1.0, 1e6, "1 to 1000000 m"),
        },
    ],
    acts: Acts::Resists,
    physics: Physics::PerUnit(|_, sample, parameters| {
        let [latitude_deg, longitude_deg, Some(length_m)] = parameters.map(Maybe::get) else {
            return 0.0;
        };
        let somewhere = latitude_deg.is_some() || longitude_deg.is_some();
        let off_squared_m2 = match sample.end.position_e7 {
            Some((latitude_e7, longitude_e7)) => {
                let degrees = |e7: i32| e7 as f32 * 1e-7;
                let here_deg = degrees(latitude_e7);
                let north_deg = here_deg - latitude_deg.unwrap_or(here_deg);
                let east_deg = longitude_deg.map_or(0.0, |there| degrees(longitude_e7) - there);
                let (north_m, east_m) = (
                    M_PER_DEG * north_deg,
                    M_PER_DEG * east_deg * cos_deg(here_deg),
                );
                north_m * north_m + east_m * east_m
            }
            None if somewhere => return 0.0,
            None => 0.0,
        };
        let reach_m = 0.5 * length_m;
        if off_squared_m2 <= reach_m * reach_m {
            sample.forces.weight_n()
        } else {
            0.0
        }
    }),
};

/// Its physics and their source.
pub static DESCRIPTION: Description = Description {
    about: "On a stretch of road the coefficient of rolling resistance is larger by the amount: gravel, coarse or broken surface.",
    source: "rough texture adds 0.001 to 0.0017 a mm of mean profile depth",
};

/// How a search varies it.
pub static SEARCH: Search = Search {
    varies: Varies::RoadSection {
        latitude_key: "latitude_deg",
        longitude_key: "longitude_deg",
        length_key: "length_m",
    },
    is_base_parameter: false,
    separated_by: "drives over other roads, and both ways over this one",
};
