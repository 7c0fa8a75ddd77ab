//! Engine, gearbox and final drive, and which gear is engaged (thesis eq. 1-4).

use super::parameter_check::{Limits, ParameterError, check_all};
use crate::scalar::Scalar;
use heapless::Vec;

/// Largest number of gears.
pub const MAX_GEARS: usize = 24;

const EFFICIENCY: &str = "above 0.5, at most 1";
/// What road vehicles have.
const LIMITS: [Limits; 4] = [
    Limits::new(
        "powertrain.engine_inertia_kgm2",
        0.0,
        100.0,
        "0 to 100 kg m²",
    ),
    Limits::new(
        "powertrain.reference_torque_nm",
        10.0,
        64_255.0,
        "10 to 64255 Nm",
    ),
    Limits::new("powertrain.final_drive_ratio", 0.5, 20.0, "0.5 to 20"),
    Limits::new("powertrain.final_drive_efficiency", 0.5, 1.0, EFFICIENCY),
];
const GEAR_LIMITS: [Limits; 2] = [
    Limits::new("powertrain.gears.ratio", 0.1, 50.0, "0.1 to 50"),
    Limits::new("powertrain.gears.efficiency", 0.5, 1.0, EFFICIENCY),
];

/// Where the traction force comes from.
#[allow(
    clippy::large_enum_variant,
    reason = "there is one a vehicle, and no allocation to box it"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum Traction {
    /// Engine torque through gearbox and final drive.
    Powertrain(Powertrain),
    /// A measured force at the wheels.
    Force,
}

/// One gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Engine turns to one turn of the output shaft.
    pub ratio: f32,
    /// Part of the power that comes through.
    pub efficiency: f32,
}

/// Engine, gearbox and final drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Powertrain {
    /// Moment of inertia of the engine, kg m².
    pub engine_inertia_kgm2: f32,
    /// Torque that 100 % stands for (SPN 544), Nm.
    pub reference_torque_nm: f32,
    /// Output shaft turns to one turn of the wheels.
    pub final_drive_ratio: f32,
    /// Part of the power that comes through the final drive.
    pub final_drive_efficiency: f32,
    /// Forward gears, first gear first.
    pub gears: Vec<Gear, MAX_GEARS>,
}

/// State of the driveline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driveline {
    /// This gear is engaged.
    Engaged(Gear),
    /// Neutral is in or the clutch is open: no torque passes.
    Open,
    /// The gear is not known.
    Unknown,
}

impl Driveline {
    /// Returns whether both are the same state; gears may differ by `tolerance`, the relative noise
    /// of a measured ratio.
    pub(crate) fn is_nearly(&self, other: &Self, tolerance: f32) -> bool {
        match (self, other) {
            (Self::Engaged(a), Self::Engaged(b)) => {
                (a.ratio - b.ratio).abs() <= tolerance * b.ratio
            }
            _ => self == other,
        }
    }
}

impl Powertrain {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let values = [
            self.engine_inertia_kgm2,
            self.reference_torque_nm,
            self.final_drive_ratio,
            self.final_drive_efficiency,
        ];
        check_all(&LIMITS, &values)?;
        if self.gears.is_empty() {
            return Err(ParameterError {
                effect: None,
                key: "powertrain.gears",
                value: 0.0,
                expected: "at least one gear, first gear first",
            });
        }
        for gear in &self.gears {
            check_all(&GEAR_LIMITS, &[gear.ratio, gear.efficiency])?;
        }
        Ok(())
    }

    /// Returns the forward gear with this number, counted from 1.
    #[must_use]
    pub fn gear(&self, number: i32) -> Option<Gear> {
        let index = usize::try_from(number.checked_sub(1)?).ok()?;
        self.gears.get(index).copied()
    }

    /// Returns the gear of a powertrain that has one (a single reduction).
    #[must_use]
    pub fn only_gear(&self) -> Option<Gear> {
        match self.gears.as_slice() {
            [gear] => Some(*gear),
            _ => None,
        }
    }

    /// Returns the gear of a measured ratio, whose relative error is at most `tolerance`.
    ///
    /// A ratio that no gear has, but that lies within the gearbox's range, gives a gear of this
    /// ratio with the efficiency of the nearest gear: a vehicle file may round its ratios. `None`
    /// beyond the range.
    #[must_use]
    pub fn gear_of_ratio(&self, ratio: f32, tolerance: f32) -> Option<Gear> {
        let distance = |gear: &Gear| off(gear, ratio);
        let mut nearest = *self.gears.first()?;
        let (mut smallest, mut largest) = (nearest.ratio, nearest.ratio);
        for gear in &self.gears {
            if distance(gear) < distance(&nearest) {
                nearest = *gear;
            }
            smallest = Scalar::min(smallest, gear.ratio);
            largest = Scalar::max(largest, gear.ratio);
        }
        if distance(&nearest) <= tolerance * nearest.ratio {
            return Some(nearest);
        }
        (ratio > 0.9 * smallest && ratio < 1.1 * largest).then_some(Gear {
            ratio,
            efficiency: nearest.efficiency,
        })
    }

    /// Returns the gear that fits an engine speed and a road speed within the relative `tolerance`;
    /// `None` below 30 rpm of the output shaft, or if no gear fits.
    #[must_use]
    pub fn gear_of_speeds(
        &self,
        engine_rpm: f32,
        speed_mps: f32,
        wheel_radius_m: f32,
        tolerance: f32,
    ) -> Option<Gear> {
        let shaft_rpm = self.shaft_rpm(speed_mps, wheel_radius_m);
        if shaft_rpm < 30.0 {
            return None;
        }
        let ratio = engine_rpm / shaft_rpm;
        self.gears
            .iter()
            .find(|gear| (gear.ratio - ratio).abs() <= tolerance * gear.ratio)
            .copied()
    }

    /// Returns the engine speed at which this gear turns without slip, rpm.
    #[must_use]
    pub fn engine_rpm(&self, gear: Gear, speed_mps: f32, wheel_radius_m: f32) -> f32 {
        self.shaft_rpm(speed_mps, wheel_radius_m) * gear.ratio
    }

    /// Returns the speed of the gearbox's output shaft, rpm.
    fn shaft_rpm(&self, speed_mps: f32, wheel_radius_m: f32) -> f32 {
        speed_mps / wheel_radius_m * self.final_drive_ratio * (30.0 / core::f32::consts::PI)
    }
}

/// Returns the difference of a gear's ratio from another one.
#[inline(never)] // So that no compiler unrolls a loop that is rarely run.
fn off(gear: &Gear, ratio: f32) -> f32 {
    (gear.ratio - ratio).abs()
}
