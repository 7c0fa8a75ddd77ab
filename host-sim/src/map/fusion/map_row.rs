//! One cell of a map, and the cells of one way.

use crate::files::columns;
use crate::files::row_check::{self, Flaw};
use crate::map::geometry::road_line::RoadPoint;
use crate::map::geometry::way_name::WayName;
use crate::numeric::rounding::round;
use serde::{Deserialize, Serialize};

/// One cell of a map. Cells that no run covered have no row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapRow {
    /// Distance along the road, m; a multiple of 2.5 m.
    pub distance_m: f64,
    /// Latitude, deg.
    pub latitude_deg: f64,
    /// Longitude, deg.
    pub longitude_deg: f64,
    /// Altitude, m; empty if no run has it.
    pub altitude_m: Option<f64>,
    /// Grade, %: 100 tan of the slope angle, positive uphill in the direction of the road.
    pub grade_percent: f64,
    /// Standard deviation of the grade, %: from the runs' sigmas and their common errors.
    pub grade_sigma_percent: f64,
    /// Number of runs.
    pub runs: u32,
}

impl MapRow {
    /// Returns the position of the cell.
    #[must_use]
    pub const fn point(&self) -> RoadPoint {
        RoadPoint {
            distance_m: self.distance_m,
            latitude_deg: self.latitude_deg,
            longitude_deg: self.longitude_deg,
        }
    }

    /// Rounds the values as text files have them.
    pub(crate) fn rounded(&self) -> Self {
        Self {
            distance_m: round(self.distance_m, 2),
            latitude_deg: round(self.latitude_deg, 7),
            longitude_deg: round(self.longitude_deg, 7),
            altitude_m: self.altitude_m.map(|v| round(v, 3)),
            grade_percent: round(self.grade_percent, 5),
            grade_sigma_percent: round(self.grade_sigma_percent, 5),
            runs: self.runs,
        }
    }

    /// Checks that the row can follow `before` in a map.
    pub(crate) fn check(before: Option<&Self>, row: &Self) -> Result<(), Flaw> {
        row_check::within(&[
            (columns::DISTANCE_M, row.distance_m),
            (columns::GRADE_PERCENT, row.grade_percent),
            (columns::GRADE_SIGMA_PERCENT, row.grade_sigma_percent),
        ])?;
        row_check::within_if_known(&[(columns::ALTITUDE_M, row.altitude_m)])?;
        row_check::position(row.latitude_deg, row.longitude_deg)?;
        before.map_or(Ok(()), |before| {
            row_check::forwards("distance_m", before.distance_m, row.distance_m, true)
        })
    }
}

/// Rows of one way.
#[derive(Clone, Debug, PartialEq)]
pub struct WayRows<T = MapRow> {
    /// Name of the way; `None` for a single road.
    pub name: Option<WayName>,
    /// Its rows, in order of distance.
    pub rows: Vec<T>,
}
