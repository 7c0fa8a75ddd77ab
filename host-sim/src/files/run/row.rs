//! A row of a RUN file: one cell of one traversal.

use crate::error::Result;
use crate::files::columns;
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
    /// Gross mass, kg (with the smoothed scale); empty in files of before it was estimated.
    #[serde(default)]
    pub mass_kg: Option<f64>,
    /// Standard deviation of the mass, kg.
    #[serde(default)]
    pub mass_sigma_kg: Option<f64>,
    /// 1 if nothing disagrees in the cell as far as the whole run tells, 0 if its sigma may be too
    /// small. Older files lack these columns: nothing is known to disagree.
    #[serde(default = "consistent")]
    pub consistent: u8,
    /// The same as it was known a fixed lag later, for the lagged grade.
    #[serde(default = "consistent")]
    pub lagged_consistent: u8,
    /// The same as it was known at the time, for the live grade.
    #[serde(default = "consistent")]
    pub live_consistent: u8,
    /// Grade of the map at the vehicle's place, %; empty without a map, and where it is left out. The
    /// live grade then has its part.
    #[serde(default)]
    pub map_grade_percent: Option<f64>,
    /// Standard deviation of the map's grade, with the error of the place, %.
    #[serde(default)]
    pub map_grade_sigma_percent: Option<f64>,
}

/// Returns the flag of a cell in which nothing is known to disagree.
const fn consistent() -> u8 {
    1
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
        row_check::within(&[
            (columns::TIME_S, row.time_s),
            (columns::DRIVEN_M, row.distance_m),
            (columns::GRADE_PERCENT, row.grade_percent),
            (columns::GRADE_SIGMA_PERCENT, row.grade_sigma_percent),
            (columns::LAGGED_GRADE_PERCENT, row.lagged_grade_percent),
            (
                columns::LAGGED_GRADE_SIGMA_PERCENT,
                row.lagged_grade_sigma_percent,
            ),
            (columns::LIVE_GRADE_PERCENT, row.live_grade_percent),
            (
                columns::LIVE_GRADE_SIGMA_PERCENT,
                row.live_grade_sigma_percent,
            ),
            (columns::SPEED_MPS, row.speed_mps),
            (columns::BIAS_PERCENT, row.bias_percent),
            (columns::SCALE, row.scale),
            (columns::VALID, row.valid.into()),
            (columns::CONSISTENT, row.consistent.into()),
            (columns::LAGGED_CONSISTENT, row.lagged_consistent.into()),
            (columns::LIVE_CONSISTENT, row.live_consistent.into()),
        ])?;
        row_check::within_if_known(&[
            (columns::LATITUDE_DEG, row.latitude_deg),
            (columns::LONGITUDE_DEG, row.longitude_deg),
            (columns::ALTITUDE_M, row.altitude_m),
            (columns::ALTITUDE_SIGMA_M, row.altitude_sigma_m),
            (columns::MASS_KG, row.mass_kg),
            (columns::MASS_SIGMA_KG, row.mass_sigma_kg),
            (columns::MAP_GRADE_PERCENT, row.map_grade_percent),
            (
                columns::MAP_GRADE_SIGMA_PERCENT,
                row.map_grade_sigma_percent,
            ),
        ])?;
        match (row.latitude_deg, row.longitude_deg) {
            (Some(_), Some(_)) | (None, None) => {}
            _ => {
                return Err(Flaw {
                    problem: "incomplete position".into(),
                    expected: "both latitude_deg and longitude_deg, or neither",
                });
            }
        }
        if row.mass_kg.is_some() != row.mass_sigma_kg.is_some() {
            return Err(Flaw {
                problem: "incomplete mass".into(),
                expected: "both mass_kg and mass_sigma_kg, or neither",
            });
        }
        if row.map_grade_percent.is_some() != row.map_grade_sigma_percent.is_some() {
            return Err(Flaw {
                problem: "incomplete grade of a map".into(),
                expected: "both map_grade_percent and map_grade_sigma_percent, or neither",
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
            // No vehicle has more than a million kilograms; a wider sigma says no more.
            mass_kg: self.mass_kg.map(|v| round(v, 1).min(1e6)),
            // A sigma below the last decimal is that decimal: zero would have infinite weight.
            mass_sigma_kg: self.mass_sigma_kg.map(|v| round(v, 1).clamp(0.1, 1e6)),
            consistent: self.consistent,
            lagged_consistent: self.lagged_consistent,
            live_consistent: self.live_consistent,
            map_grade_percent: self.map_grade_percent.map(|v| round(v, 5)),
            map_grade_sigma_percent: self.map_grade_sigma_percent.map(|v| round(v, 5)),
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
