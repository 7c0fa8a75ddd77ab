//! One point of a road file.

use crate::files::columns;
use crate::files::row_check::{self, Flaw};
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::RoadPoint;
use serde::Deserialize;

/// The distance of two points may exceed that along the road by this factor ...
const CHORD_RATIO: f64 = 1.1;
/// ... plus this, m (position error of the road data).
const CHORD_SLACK_M: f64 = 20.0;

/// One point of a road. Other columns are ignored.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct RoadRow {
    /// Distance along the road, m; grows strictly.
    pub distance_m: f64,
    /// Latitude, deg.
    pub latitude_deg: f64,
    /// Longitude, deg.
    pub longitude_deg: f64,
    /// Altitude of a reference, m.
    pub altitude_m: Option<f64>,
    /// Grade of a reference, %: 100 tan of the slope angle, positive uphill in the direction of the
    /// road.
    pub grade_percent: Option<f64>,
}

impl RoadRow {
    /// Returns the position of the point.
    pub fn point(&self) -> RoadPoint {
        RoadPoint {
            distance_m: self.distance_m,
            latitude_deg: self.latitude_deg,
            longitude_deg: self.longitude_deg,
        }
    }

    /// Checks that the row can follow `before` on a road.
    pub(crate) fn check(before: Option<&Self>, row: &Self) -> Result<(), Flaw> {
        row_check::within(&[(columns::DISTANCE_M, row.distance_m)])?;
        row_check::within_if_known(&[
            (columns::ALTITUDE_M, row.altitude_m),
            (columns::GRADE_PERCENT, row.grade_percent),
        ])?;
        row_check::position(row.latitude_deg, row.longitude_deg)?;
        let Some(before) = before else {
            return Ok(());
        };
        row_check::forwards("distance_m", before.distance_m, row.distance_m, true)?;
        // Detects columns that are swapped, or a distance in another unit.
        let place = |row: &Self| (row.latitude_deg, row.longitude_deg, 0.0);
        let apart_m = chord_m(place(before), place(row));
        let step_m = row.distance_m - before.distance_m;
        if apart_m > CHORD_RATIO * step_m + CHORD_SLACK_M {
            return Err(Flaw {
                problem: format!(
                    "{apart_m:.1} m from the point before, while distance_m grows by {step_m:.1} m"
                ),
                expected: "distance_m along the road, in m",
            });
        }
        Ok(())
    }
}
