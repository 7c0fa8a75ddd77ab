//! One step of driven distance, and what was estimated for its end.

use crate::time::Instant;

/// Length of a cell, m; the step of the thesis.
pub const CELL_LENGTH_M: f32 = 2.5;

/// What the model could be trusted with in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Condition {
    /// A gear shift, or its hold time.
    pub shifting: bool,
    /// A brake other than the engine, or its hold time.
    pub braking: bool,
    /// The traction force is not known: stale or unavailable torque, no sign of the gear.
    pub no_traction: bool,
    /// Too slow for the wheel sensors.
    pub crawling: bool,
}

impl Condition {
    /// Neither a shift nor braking, their hold times over, and a traction force to go by.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        !(self.shifting || self.braking || self.no_traction)
    }

    /// What either of two stretches suffered.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            shifting: self.shifting | other.shifting,
            braking: self.braking | other.braking,
            no_traction: self.no_traction | other.no_traction,
            crawling: self.crawling | other.crawling,
        }
    }
}

/// A number and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Uncertain {
    /// The estimate.
    pub value: f32,
    /// Its standard deviation.
    pub sigma: f32,
}

/// Where and when a cell ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Place {
    /// Number of the cell: driven distance over [`CELL_LENGTH_M`].
    pub cell: u32,
    /// When its end was reached.
    pub time: Instant,
    /// Latitude and longitude in 1e-7 degrees, if a fix was near.
    pub position_e7: Option<(i32, i32)>,
    /// Speed there as measured, m/s.
    pub speed_mps: f32,
    /// What the model could be trusted with.
    pub condition: Condition,
}

impl Place {
    /// Driven distance, m.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        f64::from(self.cell) * f64::from(CELL_LENGTH_M)
    }
}

/// The estimate at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Grade in %: 100 tan of the slope angle, positive uphill in the direction of travel.
    pub grade_percent: Uncertain,
    /// Altitude in m, in the datum of the GNSS source; not known before the first fix.
    pub altitude_m: Option<Uncertain>,
    /// Speed, m/s.
    pub speed_mps: f32,
    /// Grade that the vehicle model reads too high, %.
    pub bias_percent: Uncertain,
    /// True over modelled traction per kilogram.
    pub scale: Uncertain,
}

/// A finished cell: the live grade at its end and the one a fixed lag later.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cell {
    /// Where and when.
    pub place: Place,
    /// Grade with what was known at the cell's end, %.
    pub live_grade_percent: Uncertain,
    /// Grade with what was known a lag later, %.
    pub lagged_grade_percent: Uncertain,
    /// Altitude in m, in the datum of the GNSS source, with what was known some metres later; not
    /// known before the first fix.
    pub altitude_m: Option<Uncertain>,
}
