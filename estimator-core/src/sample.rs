//! A sample: what the filter is given for one cell.

#[cfg(doc)]
use crate::cell::CELL_LENGTH_M;
use crate::cell::{CellEnd, Disagreement};
use crate::maybe::Maybe;

/// The measurements and inputs of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Where and when the cell ends.
    pub end: CellEnd,
    /// Cells driven since the last sample without one (a gap in the traffic), normally 0.
    pub gap_cells: u32,
    /// Length of the step, m: [`CELL_LENGTH_M`].
    pub length_m: f32,
    /// Time taken, s.
    pub duration_s: f32,
    /// Mean forces and masses over the cell, scaled by the adopted effects.
    pub forces: ForceInputs,
    /// Mean force of the retarder, not negative, N.
    #[cfg_attr(feature = "serde", serde(default))]
    pub retarder_n: f32,
    /// Whether a brake that reports no force was on.
    #[cfg_attr(feature = "serde", serde(default))]
    pub service_braking: bool,
    /// What effects depend on besides the forces.
    pub effect_inputs: EffectInputs,
    /// Mean of the speed readings in the cell, if there are any.
    pub speed: Option<SpeedMeasurement>,
    /// GNSS altitude taken in the cell, if there is one.
    pub altitude: Option<AltitudeMeasurement>,
    /// Mean of the readings of an accelerometer in the cell, if there are any.
    #[cfg_attr(feature = "serde", serde(default))]
    pub inertial: Option<InertialMeasurement>,
    /// Slope that a sensor measures directly, if there is one.
    #[cfg_attr(feature = "serde", serde(default))]
    pub slope: Option<SlopeMeasurement>,
    /// The vehicle stood before this cell, for long or to be loaded. What was learned of its bias
    /// and scale may be wrong.
    pub after_load_change: bool,
    /// The vehicle stood before this cell for long enough to be loaded.
    pub after_stop: bool,
    /// Whether the mass of the forces is one that the bus reported, not the parameter.
    pub mass_is_reported: bool,
    /// Rests of the torque: how long it stayed the same, and what that may have hidden.
    #[cfg_attr(feature = "serde", serde(default))]
    pub torque_rest: TorqueRest,
    /// By how much the traction force is later than the speed, s; zero unless that is certain.
    #[cfg_attr(feature = "serde", serde(default))]
    pub traction_late_s: f32,
    /// Signals that disagree in this cell.
    pub disagreement: Disagreement,
    /// Number of cells, up to this one, in which they disagree as well; 0 without a disagreement.
    #[cfg_attr(feature = "serde", serde(default))]
    pub disagreeing_cells: u16,
}

/// Rests of the torque. A torque that rests and then jumps was unknown by up to the jump meanwhile:
/// coarse steps, a gateway that holds values, a sender that stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorqueRest {
    /// Duration of the rest that ended in the cell, s; zero without one.
    pub ended_s: f32,
    /// Jump of the force at its end, N.
    pub jump_n: f32,
    /// Duration of the rest that goes on at the cell's end, s.
    pub resting_s: f32,
    /// Force of one percent of torque, N.
    pub per_percent_n: f32,
    /// Whether the rest that ended was at a limit for most of its time: full load, overrun, a shift.
    pub ended_at_limit: bool,
    /// Whether the rest that goes on is so far.
    pub rests_at_limit: bool,
}

/// Mean of the speed readings in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpeedMeasurement {
    /// Quadratic mean, m/s: v²/2 grows evenly with distance, v does not.
    pub mean_mps: f32,
    /// Distance from where it was taken to the cell's end, m.
    pub behind_m: f32,
    /// Number of readings.
    pub count: u8,
    /// Resolution of the readings, m/s: the smallest change so far.
    pub resolution_mps: f32,
}

/// A GNSS altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AltitudeMeasurement {
    /// Altitude, m.
    pub altitude_m: f32,
    /// Distance from where it was taken to the cell's end, m.
    pub behind_m: f32,
    /// Dilution of precision, at least 1.
    pub dilution: f32,
    /// How it follows from the altitude before it.
    pub continuity: AltitudeContinuity,
}

/// Mean of the readings of a longitudinal accelerometer in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InertialMeasurement {
    /// Mean over the cell, m/s²: change of the speed plus gravity along the vehicle.
    pub acceleration_mps2: f32,
    /// Number of readings.
    pub count: u8,
    /// Resolution of the readings, m/s²: the smallest change so far.
    pub resolution_mps2: f32,
}

/// A slope that a sensor measures directly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlopeMeasurement {
    /// Sine of the slope angle, %.
    pub slope_percent: f32,
    /// What measured it.
    pub sensor: SlopeSensor,
}

/// A sensor that measures the slope directly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SlopeSensor {
    /// The vertical speed of a GNSS receiver, over the speed along the road.
    VerticalSpeed,
    /// The pitch of the body.
    Pitch,
}

/// How an altitude follows from the one before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AltitudeContinuity {
    /// Both come from the same receiver.
    #[default]
    Followed,
    /// The source is another one than before: its datum may differ by tens of metres.
    Switched,
}

/// What the force balance depends on besides the vehicle parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceInputs {
    /// Net force at the driven wheels, N.
    pub traction_n: f32,
    /// Mass that rotating parts add, kg.
    pub rotating_kg: f32,
    /// Mass of the combination, kg.
    pub mass_kg: f32,
    /// Air density, kg/m³.
    pub air_density: f32,
}

/// What effects depend on besides the forces and the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EffectInputs {
    /// Time in motion since the start or the last long stop, s.
    pub driven_s: f32,
    /// Yaw rate, positive to the left, rad/s: the mean of the readings (SPN 1808), else from the
    /// change of course.
    pub yaw_rate_radps: Maybe,
    /// Course over ground, clockwise from north, °.
    pub course_deg: Maybe,
    /// Speed over ground, m/s.
    pub gnss_speed_mps: Maybe,
    /// Fan drive (SPN 975), %.
    pub fan_percent: Maybe,
    /// Outside temperature, °C.
    pub ambient_celsius: Maybe,
    /// Whether the driveline passes torque; true for a measured force.
    pub engaged: bool,
}
