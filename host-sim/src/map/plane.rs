//! A plane in which positions are near each other.

use map_3d::Ellipsoid::WGS84;

/// How far from its origin the plane serves, m: there, lengths are 0.1 % short.
const REACH_M: f64 = 300e3;

/// East and north of an origin (tangent plane of WGS 84, altitude left out).
///
/// Lengths radial to the origin shrink by s²/2R²: 8e-6 at the ends of a 50 km road, so a lateral
/// offset of 25 m is right within a millimetre. Distances along a road are never measured here.
#[derive(Clone, Copy, Debug)]
pub struct LocalPlane {
    latitude_rad: f64,
    longitude_rad: f64,
}

impl LocalPlane {
    /// A plane that touches the ellipsoid there.
    pub fn around(latitude_deg: f64, longitude_deg: f64) -> Self {
        Self {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
        }
    }

    /// East and north, m; `None` farther away than the plane serves.
    pub fn point(&self, latitude_deg: f64, longitude_deg: f64) -> Option<[f64; 2]> {
        let (east, north, up) = map_3d::geodetic2enu(
            latitude_deg.to_radians(),
            longitude_deg.to_radians(),
            0.0,
            self.latitude_rad,
            self.longitude_rad,
            0.0,
            WGS84,
        );
        (east.hypot(north).hypot(up) <= REACH_M).then_some([east, north])
    }
}

/// Straight-line distance between two places given as latitude, longitude and altitude, m.
pub fn chord_m(from: (f64, f64, f64), to: (f64, f64, f64)) -> f64 {
    let earth_centred = |(latitude_deg, longitude_deg, altitude_m): (f64, f64, f64)| {
        map_3d::geodetic2ecef(
            latitude_deg.to_radians(),
            longitude_deg.to_radians(),
            altitude_m,
            WGS84,
        )
    };
    let (a, b) = (earth_centred(from), earth_centred(to));
    (a.0 - b.0).hypot(a.1 - b.1).hypot(a.2 - b.2)
}
