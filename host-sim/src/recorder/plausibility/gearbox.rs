//! Reported gear, gear ratio and driveline, against the ratio of engine speed and wheel speed.

use super::distribution::Distribution;
use super::warning::Warning;
use estimator_core::{Signal, Traction, VehicleParameters};
use std::f64::consts::PI;

/// Least speed at which a ratio counts, m/s.
const DRIVING_MPS: f64 = 5.0;
/// Least number of ratios from which anything is concluded.
const READINGS: u32 = 200;
/// Difference of a ratio that no rounding and no slip makes. The steps of gearboxes are 1.17 and more.
const OFF: f64 = 1.12;
/// Part of the readings in which a vehicle at speed has its driveline open at most: trucks that roll
/// by themselves come to a third.
const OPEN: f64 = 0.7;

/// Collects what gearbox and engine report.
#[derive(Clone, Debug, Default)]
pub(super) struct Gearbox {
    gear: Option<i32>,
    ratio: Option<f64>,
    is_shifting: bool,
    is_open: bool,
    engaged: u32,
    open: u32,
    /// Engine turns to a turn of the gearbox's output shaft, over the ratio that the file has for the
    /// reported gear, ...
    over_file: Distribution,
    /// ... and over the reported ratio.
    over_reported: Distribution,
}

impl Gearbox {
    /// Takes a reading.
    pub(super) fn reading(
        &mut self,
        signal: Signal,
        value: f64,
        mps: f64,
        vehicle: &VehicleParameters,
    ) {
        match signal {
            Signal::CurrentGear => self.gear = Some(value.round() as i32),
            Signal::GearRatio => self.ratio = Some(value),
            Signal::ShiftInProcess => self.is_shifting = value > 0.5,
            Signal::DrivelineEngaged => {
                self.is_open = value < 0.5;
                if mps >= DRIVING_MPS {
                    let count = if self.is_open {
                        &mut self.open
                    } else {
                        &mut self.engaged
                    };
                    *count = count.saturating_add(1);
                }
            }
            Signal::EngineSpeed => self.engine_speed(value, mps, vehicle),
            _ => {}
        }
    }

    fn engine_speed(&mut self, rpm: f64, mps: f64, vehicle: &VehicleParameters) {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return;
        };
        if mps < DRIVING_MPS || rpm <= 0.0 || self.is_shifting || self.is_open {
            return;
        }
        let wheels_rpm = mps / f64::from(vehicle.wheel_radius_m) * 30.0 / PI;
        let ratio = rpm / (wheels_rpm * f64::from(powertrain.final_drive_ratio));
        let index = self.gear.and_then(|gear| usize::try_from(gear - 1).ok());
        let gears = &powertrain.gears;
        if let Some(gear) = index.and_then(|index| gears.get(index)) {
            self.over_file.add(ratio / f64::from(gear.ratio));
        } else if self.gear.is_some_and(|gear| gear > 0) {
            // A gear that the file does not have.
            self.over_file.add(f64::INFINITY);
        }
        if let Some(reported) = self.ratio.filter(|ratio| *ratio > 0.0) {
            self.over_reported.add(ratio / reported);
        }
    }

    /// Returns what is not plausible.
    pub(super) fn judge(&self) -> Option<Warning> {
        let readings = self.engaged.saturating_add(self.open);
        if readings >= READINGS && f64::from(self.open) > OPEN * f64::from(readings) {
            return Some(Warning::major(
                "driveline_open",
                "the driveline is reported open nearly always",
                format!(
                    "the driveline is reported open in {:.0} % of the readings above {DRIVING_MPS} m/s, \
                     so the vehicle model does not hold there",
                    100.0 * f64::from(self.open) / f64::from(readings)
                ),
                "check the driveline signal (ETC1, SPN 560; column driveline_engaged): 1 is engaged; or \
                 leave it out with --ignore driveline_engaged",
            ));
        }
        let is_off = |factor: &f64| factor.ln().abs() > OFF.ln();
        let factor = |of: &Distribution| of.median_of(READINGS).filter(is_off);
        if let Some(factor) = factor(&self.over_reported) {
            return Some(Warning::minor(
                "gear_ratio_unit",
                format!(
                    "the engine turns {factor:.3} times as fast as the reported gear ratio says, with \
                     final drive and wheel radius of the vehicle file"
                ),
                "check the gear ratio (ETC2, SPN 526; column gear_ratio), which is input over output \
                 speed of the gearbox, and final_drive_ratio and wheel_radius_m in the vehicle file",
            ));
        }
        let factor = factor(&self.over_file)?;
        let how = if factor > 1e6 {
            "most of the reported gears are not in the vehicle file".to_owned()
        } else {
            format!(
                "the engine turns {factor:.3} times as fast as the reported gear says, by the \
                 vehicle file"
            )
        };
        Some(Warning::minor(
            "gear_number",
            how,
            "check the reported gear (ETC2, SPN 523; column gear), which is 1 for the first gear, \
             and gears, final_drive_ratio and wheel_radius_m in the vehicle file",
        ))
    }
}
