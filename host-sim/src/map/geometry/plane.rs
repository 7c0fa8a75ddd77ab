//! A local tangent plane.

use map_3d::Ellipsoid::WGS84;

/// Range of the plane around its origin, m; lengths at its edge are 0.1 % short.
const REACH_M: f64 = 300e3;

/// East and north of an origin (tangent plane of WGS 84, without altitude).
///
/// Lengths radial to the origin are short by s²/2R²: 8e-6 at the ends of a 50 km road, so a lateral
/// offset of 25 m is accurate to a millimetre. Distances along a road are never measured here.
#[derive(Clone, Copy, Debug)]
pub struct LocalPlane {
    /// Earth-centred, m.
    origin_m: [f64; 3],
    /// Unit vectors to the east, north and up, earth-centred.
    axes: [[f64; 3]; 3],
}

impl LocalPlane {
    /// Creates the plane that touches the ellipsoid at this position.
    pub fn around(latitude_deg: f64, longitude_deg: f64) -> Self {
        let (sin_lat, cos_lat) = latitude_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = longitude_deg.to_radians().sin_cos();
        Self {
            origin_m: earth_centred(latitude_deg, longitude_deg),
            axes: [
                [-sin_lon, cos_lon, 0.0],
                [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
                [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
            ],
        }
    }

    /// Returns east and north of a place on the ellipsoid, m; `None` beyond the range of the plane.
    pub fn point(&self, place_m: [f64; 3]) -> Option<[f64; 2]> {
        let [east, north, up] = self.axes.map(|axis| {
            (0..3)
                .map(|i| axis[i] * (place_m[i] - self.origin_m[i]))
                .sum::<f64>()
        });
        let squared = east * east + north * north + up * up;
        (squared <= REACH_M * REACH_M).then_some([east, north])
    }
}

/// Returns earth-centred coordinates of a position on the ellipsoid, m.
pub fn earth_centred(latitude_deg: f64, longitude_deg: f64) -> [f64; 3] {
    let (latitude, longitude) = (latitude_deg.to_radians(), longitude_deg.to_radians());
    map_3d::geodetic2ecef(latitude, longitude, 0.0, WGS84).into()
}

/// Returns the straight-line distance between two positions (latitude, longitude, altitude), m.
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
