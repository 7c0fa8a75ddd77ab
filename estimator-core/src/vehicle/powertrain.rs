//! From engine torque to force at the wheels (thesis eq. 1-4).

use super::{ParameterError, VehicleParameters, check};
use heapless::Vec;

/// Gears of the largest gearbox.
pub const MAX_GEARS: usize = 24;

/// Where the traction force comes from.
#[allow(
    clippy::large_enum_variant,
    reason = "one a vehicle, and nowhere to put it without allocation"
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

/// What is known of the driveline's state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driveline {
    /// This gear is engaged.
    Engaged(Gear),
    /// Neutral, or clutch open: no torque passes.
    Open,
    /// No usable sign of a gear.
    Unknown,
}

impl Driveline {
    /// Whether this is the same state, in a gear whose ratio was only measured a little
    /// differently.
    pub(crate) fn is_nearly(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Engaged(a), Self::Engaged(b)) => {
                (a.ratio - b.ratio).abs() <= RATIO_TOLERANCE * b.ratio
            }
            _ => self == other,
        }
    }
}

/// How far a measured ratio may be from a gear's to be that gear.
const RATIO_TOLERANCE: f32 = 0.05;

impl Powertrain {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let efficiency = "above 0.5, at most 1";
        check(
            "powertrain.engine_inertia_kgm2",
            self.engine_inertia_kgm2,
            0.0,
            100.0,
            "0 to 100 kg m²",
        )?;
        check(
            "powertrain.reference_torque_nm",
            self.reference_torque_nm,
            10.0,
            64_255.0,
            "10 to 64255 Nm",
        )?;
        check(
            "powertrain.final_drive_ratio",
            self.final_drive_ratio,
            0.5,
            20.0,
            "0.5 to 20",
        )?;
        check(
            "powertrain.final_drive_efficiency",
            self.final_drive_efficiency,
            0.5,
            1.0,
            efficiency,
        )?;
        if self.gears.is_empty() {
            return Err(ParameterError {
                effect: None,
                key: "powertrain.gears",
                value: 0.0,
                expected: "at least one gear, first gear first",
            });
        }
        for gear in &self.gears {
            check("powertrain.gears.ratio", gear.ratio, 0.1, 50.0, "0.1 to 50")?;
            check(
                "powertrain.gears.efficiency",
                gear.efficiency,
                0.5,
                1.0,
                efficiency,
            )?;
        }
        Ok(())
    }

    /// The forward gear with this number, from 1.
    #[must_use]
    pub fn gear(&self, number: i32) -> Option<Gear> {
        let index = usize::try_from(number.checked_sub(1)?).ok()?;
        self.gears.get(index).copied()
    }

    /// The gear whose ratio is this one.
    ///
    /// A ratio that no gear has is believed all the same, with the efficiency of the nearest
    /// (the vehicle file may round its ratios), unless it is beyond the gearbox's range.
    #[must_use]
    pub fn gear_of_ratio(&self, ratio: f32) -> Option<Gear> {
        let distance = |gear: &Gear| (gear.ratio - ratio).abs();
        let nearest = self
            .gears
            .iter()
            .reduce(|a, b| if distance(b) < distance(a) { b } else { a })?;
        if distance(nearest) <= RATIO_TOLERANCE * nearest.ratio {
            return Some(*nearest);
        }
        let largest = self.gears.iter().fold(0.0_f32, |m, g| m.max(g.ratio));
        let smallest = self.gears.iter().fold(largest, |m, g| m.min(g.ratio));
        (ratio > 0.9 * smallest && ratio < 1.1 * largest).then_some(Gear {
            ratio,
            efficiency: nearest.efficiency,
        })
    }

    /// The gear that fits an engine speed and a road speed, within 5 %.
    #[must_use]
    pub fn gear_of_speeds(
        &self,
        engine_rpm: f32,
        speed_mps: f32,
        wheel_radius_m: f32,
    ) -> Option<Gear> {
        let shaft_rpm = self.shaft_rpm(speed_mps, wheel_radius_m);
        if shaft_rpm < 30.0 {
            return None;
        }
        let ratio = engine_rpm / shaft_rpm;
        self.gears
            .iter()
            .find(|gear| (gear.ratio - ratio).abs() <= RATIO_TOLERANCE * gear.ratio)
            .copied()
    }

    /// Engine speed at which this gear turns without slip, rpm.
    #[must_use]
    pub fn engine_rpm(&self, gear: Gear, speed_mps: f32, wheel_radius_m: f32) -> f32 {
        self.shaft_rpm(speed_mps, wheel_radius_m) * gear.ratio
    }

    /// Speed of the gearbox's output shaft, rpm.
    fn shaft_rpm(&self, speed_mps: f32, wheel_radius_m: f32) -> f32 {
        speed_mps / wheel_radius_m * self.final_drive_ratio * (30.0 / core::f32::consts::PI)
    }
}

impl VehicleParameters {
    /// Force at the wheels in N for a net engine torque in percent of the reference (eq. 9, left
    /// side).
    #[must_use]
    pub fn traction_n(&self, driveline: Driveline, net_torque_percent: f32) -> f32 {
        match (&self.traction, driveline) {
            (Traction::Powertrain(p), Driveline::Engaged(gear)) => {
                let torque_nm = p.reference_torque_nm * net_torque_percent * 0.01;
                torque_nm
                    * gear.ratio
                    * gear.efficiency
                    * p.final_drive_ratio
                    * p.final_drive_efficiency
                    / self.believed_radius_m()
            }
            _ => 0.0,
        }
    }

    /// Mass in kg that wheels and, through the engaged gear, the engine add (eq. 9).
    #[must_use]
    pub fn rotating_kg(&self, driveline: Driveline) -> f32 {
        let engine = match (&self.traction, driveline) {
            (Traction::Powertrain(p), Driveline::Engaged(gear)) => {
                let ratio = gear.ratio * p.final_drive_ratio;
                ratio * ratio * gear.efficiency * p.final_drive_efficiency * p.engine_inertia_kgm2
            }
            _ => 0.0,
        };
        let radius_m = self.believed_radius_m();
        (self.wheel_inertia_kgm2 + engine) / (radius_m * radius_m)
    }
}
