//! A cell: one step of driven distance, and what the estimator says about its end.

use crate::time::Instant;

/// Length of a cell, m; the step of the thesis.
pub const CELL_LENGTH_M: f32 = 2.5;

/// Why the vehicle model does not hold in a cell; all false where it holds.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Condition {
    /// A gear shift or its hold time is on.
    pub shifting: bool,
    /// A brake other than the engine, or its hold time, is on.
    pub braking: bool,
    /// The traction force is unknown: torque is stale or not available, or the gear is unknown.
    pub no_traction: bool,
    /// The speed is too low for the wheel sensors. The model still holds.
    pub crawling: bool,
}

impl Condition {
    /// Returns whether the vehicle model holds: no shift, no braking, their hold times over, and the
    /// traction force known.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        !(self.shifting || self.braking || self.no_traction)
    }

    /// Returns the union of both conditions.
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

/// What disagrees in a cell: signals that cannot all be right. All false where everything agrees.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Disagreement {
    /// Climb by GNSS and climb by the forces.
    pub climb: bool,
    /// Descent by GNSS and a vehicle that gains no speed: a brake that no signal reports.
    pub brake: bool,
    /// Torque and acceleration or climb, or torque that another sender than the engine gives.
    pub torque: bool,
    /// Wheel speed and engine speed, or wheel speeds of two senders.
    pub speed: bool,
    /// Reported gear, engine speed and wheel speed.
    pub gear: bool,
}

impl Disagreement {
    /// Everything agrees.
    pub const NONE: Self = Self {
        climb: false,
        brake: false,
        torque: false,
        speed: false,
        gear: false,
    };

    /// Number of kinds of disagreement.
    pub const KINDS: usize = 5;

    /// Returns whether everything agrees.
    #[must_use]
    pub const fn is_none(self) -> bool {
        !(self.climb | self.brake | self.torque | self.speed | self.gear)
    }

    /// Returns whether each kind is present, in the order of the fields.
    #[must_use]
    pub const fn kinds(self) -> [bool; Self::KINDS] {
        let Self {
            climb,
            brake,
            torque,
            speed,
            gear,
        } = self;
        [climb, brake, torque, speed, gear]
    }

    /// Returns what counts of it: nothing where the slope is known within `percent` all the same.
    #[must_use]
    pub const fn where_uncertain(self, variance: f32, percent: f32) -> Self {
        if variance < percent * percent {
            Self::NONE
        } else {
            self
        }
    }

    /// Returns the union of both.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            climb: self.climb | other.climb,
            brake: self.brake | other.brake,
            torque: self.torque | other.torque,
            speed: self.speed | other.speed,
            gear: self.gear | other.gear,
        }
    }
}

/// An estimate with its standard deviation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Uncertain {
    /// The estimate.
    pub value: f32,
    /// Its standard deviation.
    pub sigma: f32,
}

impl Uncertain {
    /// Returns the estimate plus a number that is known exactly.
    #[must_use]
    pub const fn plus(self, number: f32) -> Self {
        Self {
            value: number + self.value,
            ..self
        }
    }

    /// Returns whether it is the grade of a road, %, with a standard deviation that counts.
    pub(crate) fn is_possible_grade(self) -> bool {
        self.value.abs() < 100.0 && self.sigma > 0.0 && self.sigma.is_finite()
    }
}

/// Where and when a cell ends, and whether the vehicle model holds in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CellEnd {
    /// Number of the cell: driven distance divided by [`CELL_LENGTH_M`].
    pub cell: u32,
    /// Time at which the vehicle reaches the end.
    pub time: Instant,
    /// Latitude and longitude, 1e-7 degrees; `None` without a fix within 200 m.
    pub position_e7: Option<(i32, i32)>,
    /// Measured speed at the end, m/s.
    pub speed_mps: f32,
    /// Whether the vehicle model holds.
    pub condition: Condition,
}

impl CellEnd {
    /// Returns the driven distance, m.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        f64::from(self.cell) * f64::from(CELL_LENGTH_M)
    }
}

/// The estimate at the end of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Grade in %: 100 tan of the slope angle, positive uphill in the direction of travel.
    pub grade_percent: Uncertain,
    /// Altitude in m, in the datum of the GNSS source; `None` before the first fix.
    pub altitude_m: Option<Uncertain>,
    /// Speed, m/s.
    pub speed_mps: f32,
    /// Bias of the vehicle model: the grade that it reads too high, %.
    pub bias_percent: Uncertain,
    /// Scale factor of the vehicle model: true over modelled traction per kilogram, 1.
    pub scale: Uncertain,
    /// Gross mass of the combination, kg: that of the model over the scale, combined with a reported
    /// one.
    pub mass_kg: Uncertain,
}

/// The live estimate: what is known at the end of the newest cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Live {
    /// The end of the newest cell.
    pub end: CellEnd,
    /// The estimate there.
    pub estimate: Estimate,
    /// What disagrees there, as far as it is known.
    pub disagreement: Disagreement,
}

/// A finished cell: the live grade at its end, and the lagged grade.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cell {
    /// Where and when the cell ends.
    pub end: CellEnd,
    /// Live grade: from the measurements up to the cell's end, %.
    pub live_grade_percent: Uncertain,
    /// Lagged grade: from the measurements up to a fixed lag later, %.
    pub lagged_grade_percent: Uncertain,
    /// Altitude in m, in the datum of the GNSS source, smoothed over the window; `None`
    /// before the first fix.
    pub altitude_m: Option<Uncertain>,
    /// Whether nothing disagreed at the cell's end, as far as it was known there. Where it is
    /// false, the sigma of the live grade may be too small.
    pub live_consistent: bool,
    /// Whether nothing disagrees here, as far as it is known a fixed lag later.
    pub lagged_consistent: bool,
}
