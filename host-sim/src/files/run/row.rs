//! A row of a RUN file: one cell of one traversal.

use crate::error::Result;
use crate::files::csv::column;
use crate::files::row_check::{self, Flaw};
use crate::numeric::rounding::round;
use serde::{Deserialize, Serialize};

/// One cell of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRow {
    /// Time since the first frame of the log, s.
    pub time_s: f64,
    /// Driven distance at the end of the cell, m.
    pub distance_m: f64,
    /// Latitude, deg; empty without a fix nearby.
    #[serde(deserialize_with = "column")]
    pub latitude_deg: Option<f64>,
    /// Longitude, deg; empty without a fix nearby.
    #[serde(deserialize_with = "column")]
    pub longitude_deg: Option<f64>,
    /// Altitude, m; empty before the first fix.
    #[serde(deserialize_with = "column")]
    pub altitude_m: Option<f64>,
    #[serde(deserialize_with = "column")]
    /// Standard deviation of the altitude, m; empty before the first fix.
    pub altitude_sigma_m: Option<f64>,
    /// Smoothed grade over the whole run, %.
    pub grade_percent: f64,
    /// Standard deviation of the smoothed grade, %.
    pub grade_sigma_percent: f64,
    /// Grade after a fixed lag, %.
    pub lagged_grade_percent: f64,
    /// Standard deviation of the lagged grade, %.
    pub lagged_grade_sigma_percent: f64,
    /// Causal grade, %.
    pub live_grade_percent: f64,
    /// Standard deviation of the live grade, %.
    pub live_grade_sigma_percent: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Bias of the vehicle model as grade, % (smoothed); positive if the modelled grade is too
    /// high.
    pub bias_percent: f64,
    /// True over modelled traction (smoothed).
    pub scale: f64,
    /// 1 if the vehicle model is valid; 0 during shifts, braking and their hold times.
    pub valid: u8,
}

impl RunRow {
    /// Returns the smoothed grade and its standard deviation, %.
    #[must_use]
    pub const fn smoothed(&self) -> (f64, f64) {
        (self.grade_percent, self.grade_sigma_percent)
    }

    /// Returns the lagged grade and its standard deviation, %.
    #[must_use]
    pub const fn lagged(&self) -> (f64, f64) {
        (self.lagged_grade_percent, self.lagged_grade_sigma_percent)
    }

    /// Returns the live grade and its standard deviation, %.
    #[must_use]
    pub const fn live(&self) -> (f64, f64) {
        (self.live_grade_percent, self.live_grade_sigma_percent)
    }

    /// Checks that the row can follow `before` in a run.
    pub(crate) fn check(before: Option<&Self>, row: &Self) -> std::result::Result<(), Flaw> {
        row_check::finite(&[
            ("time_s", row.time_s),
            ("distance_m", row.distance_m),
            ("latitude_deg", row.latitude_deg.unwrap_or(0.0)),
            ("longitude_deg", row.longitude_deg.unwrap_or(0.0)),
            ("altitude_m", row.altitude_m.unwrap_or(0.0)),
            ("altitude_sigma_m", row.altitude_sigma_m.unwrap_or(1.0)),
            ("grade_percent", row.grade_percent),
            ("grade_sigma_percent", row.grade_sigma_percent),
            ("lagged_grade_percent", row.lagged_grade_percent),
            ("lagged_grade_sigma_percent", row.lagged_grade_sigma_percent),
            ("live_grade_percent", row.live_grade_percent),
            ("live_grade_sigma_percent", row.live_grade_sigma_percent),
            ("speed_mps", row.speed_mps),
            ("bias_percent", row.bias_percent),
            ("scale", row.scale),
        ])?;
        row_check::positive(&[
            ("altitude_sigma_m", row.altitude_sigma_m.unwrap_or(1.0)),
            ("grade_sigma_percent", row.grade_sigma_percent),
            ("lagged_grade_sigma_percent", row.lagged_grade_sigma_percent),
            ("live_grade_sigma_percent", row.live_grade_sigma_percent),
        ])?;
        match (row.latitude_deg, row.longitude_deg) {
            (Some(latitude_deg), Some(longitude_deg)) => {
                row_check::position(latitude_deg, longitude_deg)?;
            }
            (None, None) => {}
            _ => {
                return Err(Flaw {
                    problem: "incomplete position".into(),
                    expected: "both latitude_deg and longitude_deg, or neither",
                });
            }
        }
        if row.valid > 1 {
            return Err(Flaw {
                problem: format!("valid is {}", row.valid),
                expected: "0 or 1",
            });
        }
        before.map_or(Ok(()), |before| {
            row_check::forwards("time_s", before.time_s, row.time_s, false)?;
            row_check::forwards("distance_m", before.distance_m, row.distance_m, true)
        })
    }

    /// Rounds the values as files have them.
    pub(super) fn rounded(&self) -> Self {
        Self {
            time_s: round(self.time_s, 4),
            distance_m: round(self.distance_m, 2),
            latitude_deg: self.latitude_deg.map(|v| round(v, 7)),
            longitude_deg: self.longitude_deg.map(|v| round(v, 7)),
            altitude_m: self.altitude_m.map(|v| round(v, 3)),
            altitude_sigma_m: self.altitude_sigma_m.map(|v| round(v, 3)),
            grade_percent: round(self.grade_percent, 5),
            grade_sigma_percent: round(self.grade_sigma_percent, 5),
            lagged_grade_percent: round(self.lagged_grade_percent, 5),
            lagged_grade_sigma_percent: round(self.lagged_grade_sigma_percent, 5),
            live_grade_percent: round(self.live_grade_percent, 5),
            live_grade_sigma_percent: round(self.live_grade_sigma_percent, 5),
            speed_mps: round(self.speed_mps, 4),
            bias_percent: round(self.bias_percent, 5),
            scale: round(self.scale, 5),
            valid: self.valid,
        }
    }
}

/// Rows of a run that can be read more than once.
pub trait RunRows {
    /// Passes all rows to `take`, in the order of the run.
    ///
    /// # Errors
    /// Returns the error of `take`, or an error if the rows cannot be read.
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()>;
}

impl RunRows for &[RunRow] {
    fn each(&mut self, take: &mut dyn FnMut(&RunRow) -> Result<()>) -> Result<()> {
        self.iter().try_for_each(take)
    }
}
