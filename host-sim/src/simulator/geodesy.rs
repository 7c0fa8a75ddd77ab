//! Short displacements on the WGS-84 ellipsoid.

use std::f64::consts::PI;

/// Semi-major axis of WGS-84, m.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// First eccentricity of WGS-84, squared.
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;

/// A position in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Latitude, deg, positive to the north.
    pub latitude_deg: f64,
    /// Longitude, deg, positive to the east.
    pub longitude_deg: f64,
}

impl Position {
    /// Returns the radii of curvature, m, of the meridian and of the parallel: metres per radian of
    /// latitude and of longitude.
    fn radii_m(self) -> (f64, f64) {
        let (sin, cos) = self.latitude_deg.to_radians().sin_cos();
        let w = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
        let meridian = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED) / (w * w.sqrt());
        let parallel = SEMI_MAJOR_M / w.sqrt() * cos;
        (meridian, parallel)
    }

    /// Returns the position `north_m` and `east_m` away; valid for short displacements.
    #[must_use]
    pub fn moved(self, north_m: f64, east_m: f64) -> Self {
        let (meridian, parallel) = self.radii_m();
        Self {
            latitude_deg: self.latitude_deg + (north_m / meridian).to_degrees(),
            longitude_deg: self.longitude_deg + (east_m / parallel).to_degrees(),
        }
    }

    /// Returns the course to `other`, rad clockwise from north.
    #[must_use]
    pub fn course_to_rad(self, other: Self) -> f64 {
        let (meridian, parallel) = self.radii_m();
        let north = (other.latitude_deg - self.latitude_deg) * meridian;
        let east = (other.longitude_deg - self.longitude_deg) * parallel;
        east.atan2(north)
    }

    /// Returns the position at the part `part` of the distance to `other`.
    #[must_use]
    pub fn towards(self, other: Self, part: f64) -> Self {
        Self {
            latitude_deg: self.latitude_deg + part * (other.latitude_deg - self.latitude_deg),
            longitude_deg: self.longitude_deg + part * (other.longitude_deg - self.longitude_deg),
        }
    }
}

/// Wraps an angle to -π to π.
#[must_use]
pub fn wrapped_rad(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(2.0 * PI) - PI
}
