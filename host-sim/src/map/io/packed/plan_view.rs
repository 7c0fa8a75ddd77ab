//! The plan view of a block: the few points between which cells lie evenly on straight lines.

use crate::map::fusion::map_row::MapRow;

/// Largest distance of a cell from where the points put it, m. A tenth of a lane.
const TOLERANCE_M: f64 = 0.3;
/// Length of a degree of latitude, m.
const DEGREE_M: f64 = 111_200.0;

/// A place on the grid of the format, 10⁻⁶ degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) latitude_e6: i32,
    pub(super) longitude_e6: i32,
}

impl Place {
    /// Returns the place of a row.
    pub(super) fn of(row: &MapRow) -> Self {
        let rounded = |degrees: f64| (degrees * 1e6).round() as i32;
        Self {
            latitude_e6: rounded(row.latitude_deg),
            longitude_e6: rounded(row.longitude_deg),
        }
    }

    /// Returns the change of latitude and longitude from another place, the short way round.
    pub(super) const fn since(self, other: Self) -> (i32, i32) {
        const TURN_E6: i32 = 360_000_000;
        let longitude = self.longitude_e6 - other.longitude_e6;
        let short = match longitude {
            east if east > TURN_E6 / 2 => east - TURN_E6,
            west if west < -TURN_E6 / 2 => west + TURN_E6,
            other => other,
        };
        (self.latitude_e6 - other.latitude_e6, short)
    }

    /// Returns the distance east and north of another place, m.
    fn metres_from(self, other: Self) -> [f64; 2] {
        let (latitude, longitude) = self.since(other);
        let cosine = (f64::from(other.latitude_e6) * 1e-6).to_radians().cos();
        [
            f64::from(longitude) * 1e-6 * DEGREE_M * cosine,
            f64::from(latitude) * 1e-6 * DEGREE_M,
        ]
    }
}

/// Returns the indices of the places that suffice, the first and the last among them. All others
/// are within the tolerance of the straight line at their part of the cells (Douglas and Peucker
/// 1973, with the distance at the same time of Meratnia and de By 2004).
pub(super) fn points(places: &[Place]) -> Vec<usize> {
    let mut kept = vec![0];
    let mut ends = vec![places.len() - 1];
    while let (Some(&from), Some(&to)) = (kept.last(), ends.last()) {
        match worst(places, from, to) {
            Some(between) => ends.push(between),
            None => {
                if to > from {
                    kept.push(to);
                }
                ends.pop();
            }
        }
    }
    kept
}

/// Returns the place that is farthest from the line between two, if it is beyond the tolerance.
fn worst(places: &[Place], from: usize, to: usize) -> Option<usize> {
    let end = places[to].metres_from(places[from]);
    let off = |i: usize| {
        let part = (i - from) as f64 / (to - from) as f64;
        let here = places[i].metres_from(places[from]);
        (here[0] - part * end[0]).hypot(here[1] - part * end[1])
    };
    (from + 1..to)
        .map(|i| (i, off(i)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, off_m)| *off_m > TOLERANCE_M)
        .map(|(i, _)| i)
}
