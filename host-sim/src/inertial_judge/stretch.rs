//! The road between two points of a profile.

use super::profile::{GRAVITY_MPS2, ProfilePoint};

/// A stretch of road without a break.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Distance driven, m; above 0.
    pub length_m: f64,
    /// Climb, as the accelerometer shows it, m.
    pub climb_m: f64,
    /// Mean acceleration over the distance, m/s²: the change of kinetic energy a kilogram and metre.
    pub acceleration_mps2: f64,
}

impl Stretch {
    /// Returns the stretch between two points; `None` if there is a break in it, or no way.
    #[must_use]
    pub fn between(from: &ProfilePoint, to: &ProfilePoint) -> Option<Self> {
        let length_m = to.distance_m - from.distance_m;
        let kinetic = 0.5 * (to.speed_mps.powi(2) - from.speed_mps.powi(2));
        (from.breaks == to.breaks && length_m > 0.0).then_some(Self {
            length_m,
            climb_m: to.climb_m - from.climb_m,
            acceleration_mps2: kinetic / length_m,
        })
    }

    /// Returns the sine of the mean slope; beyond ±1 where the sensor is at fault.
    #[must_use]
    pub fn sine(&self) -> f64 {
        self.climb_m / self.length_m
    }

    /// Returns the mean reading over the distance, motion and gravity together, m/s².
    #[must_use]
    pub fn reading_mps2(&self) -> f64 {
        GRAVITY_MPS2 * self.sine() + self.acceleration_mps2
    }
}
