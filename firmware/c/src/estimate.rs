//! Estimates as C sees them.

use estimator_core::{Cell, CellEnd, Condition, Disagreement, Live, Uncertain};

/// Where and when a cell of 2.5 m ends.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct End {
    /// Time at which the vehicle reaches it, µs, by the clock of the frames.
    pub time_us: u64,
    /// Driven distance divided by 2.5 m.
    pub cell: u32,
    /// Whether the position is known.
    pub has_position: bool,
    /// Latitude, 1e-7 degrees.
    pub latitude_e7: i32,
    /// Longitude, 1e-7 degrees.
    pub longitude_e7: i32,
    /// Measured speed, m/s.
    pub speed_mps: f32,
    /// Why the vehicle model does not hold; all false where it holds.
    pub condition: Condition,
}

/// What is known at the end of the newest cell.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiveEstimate {
    /// The end of the newest cell.
    pub end: End,
    /// Grade: 100 tan of the slope angle, positive uphill in the direction of travel, %.
    pub grade_percent: Uncertain,
    /// Whether the altitude is known.
    pub has_altitude: bool,
    /// Altitude in the datum of the GNSS source, m.
    pub altitude_m: Uncertain,
    /// Bias of the vehicle model: the grade that it reads too high, %.
    pub bias_percent: Uncertain,
    /// Scale factor of the vehicle model, 1.
    pub scale: Uncertain,
    /// Gross mass of the combination, kg.
    pub mass_kg: Uncertain,
    /// What disagrees here. Where anything does, the sigma may be too small.
    pub disagreement: Disagreement,
}

/// A finished cell, 500 m back.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FinishedCell {
    /// Where and when it ends.
    pub end: End,
    /// Live grade: from the measurements up to its end, %.
    pub live_grade_percent: Uncertain,
    /// Lagged grade: from the measurements up to a fixed lag later, %.
    pub lagged_grade_percent: Uncertain,
    /// Whether the altitude is known.
    pub has_altitude: bool,
    /// Altitude in the datum of the GNSS source, m.
    pub altitude_m: Uncertain,
    /// Whether nothing disagreed, as far as was known at its end.
    pub live_consistent: bool,
    /// Whether nothing disagrees, as far as is known a fixed lag later.
    pub lagged_consistent: bool,
}

impl From<CellEnd> for End {
    fn from(end: CellEnd) -> Self {
        let (latitude_e7, longitude_e7) = end.position_e7.unwrap_or_default();
        Self {
            time_us: end.time.micros(),
            cell: end.cell,
            has_position: end.position_e7.is_some(),
            latitude_e7,
            longitude_e7,
            speed_mps: end.speed_mps,
            condition: end.condition,
        }
    }
}

impl From<Live> for LiveEstimate {
    fn from(live: Live) -> Self {
        let estimate = live.estimate;
        Self {
            end: live.end.into(),
            grade_percent: estimate.grade_percent,
            has_altitude: estimate.altitude_m.is_some(),
            altitude_m: estimate.altitude_m.unwrap_or_default(),
            bias_percent: estimate.bias_percent,
            scale: estimate.scale,
            mass_kg: estimate.mass_kg,
            disagreement: live.disagreement,
        }
    }
}

impl From<Cell> for FinishedCell {
    fn from(cell: Cell) -> Self {
        Self {
            end: cell.end.into(),
            live_grade_percent: cell.live_grade_percent,
            lagged_grade_percent: cell.lagged_grade_percent,
            has_altitude: cell.altitude_m.is_some(),
            altitude_m: cell.altitude_m.unwrap_or_default(),
            live_consistent: cell.live_consistent,
            lagged_consistent: cell.lagged_consistent,
        }
    }
}
