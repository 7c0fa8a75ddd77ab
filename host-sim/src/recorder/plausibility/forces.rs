//! Units of torque, force and engine speed.

use super::distribution::Distribution;
use super::warning::Warning;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{Powertrain, Traction, VehicleParameters};
use std::f64::consts::PI;

/// Least way from which a torque is judged, m.
const LEAST_M: f64 = 1_000.0;
/// Largest torque that J1939 can report, %.
const LARGEST_PERCENT: f64 = 125.0;
/// Torque that every driven vehicle exceeds, %.
const SMALL_PERCENT: f64 = 2.0;
/// Torque below zero that shows a sign, %.
const TURNED_PERCENT: f64 = -10.0;
/// Friction that every engine exceeds, %.
const SMALL_FRICTION_PERCENT: f64 = 1.0;
/// Step of torques on J1939, %.
const STEP_PERCENT: f64 = 0.125;
/// Part of the weight that every driven vehicle's force exceeds: half of what rolling takes.
const SMALL_FORCE: f64 = 0.002;
/// Part of the weight that tyres cannot pass to the road.
const LARGE_FORCE: f64 = 1.5;
/// Least speed at which the engine speed is judged, m/s.
const DRIVING_MPS: f64 = 5.0;
/// Speed below which no engine runs under load, rpm.
const IDLE_RPM: f64 = 400.0;
/// Speed that J1939 can report, which only motors exceed, rpm; ...
const LARGEST_RPM: f64 = 8_031.875;
/// ... that of engines which turn slowly, and the least reference torque of these, Nm.
const TRUCK_RPM: f64 = 3_500.0;
const TRUCK_NM: f32 = 600.0;
/// Speed below which an engine is off, rpm.
const OFF_RPM: f64 = 5.0;
/// Least number of engine speeds that are judged.
const READINGS: u32 = 100;

/// Counts values by size.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    count: u32,
    nonzero: u32,
    /// Of these, values that no J1939 message can have.
    fine: u32,
    /// Values beyond what J1939 can report.
    beyond: u32,
    range: Option<(f64, f64)>,
}

impl Sizes {
    fn add(&mut self, value: f64) {
        self.count = self.count.saturating_add(1);
        self.nonzero += u32::from(value != 0.0);
        self.fine += u32::from((value / STEP_PERCENT).fract() != 0.0);
        self.beyond += u32::from(value.abs() > LARGEST_PERCENT);
        let (low, high) = self.range.unwrap_or((value, value));
        self.range = Some((low.min(value), high.max(value)));
    }

    fn largest(&self) -> f64 {
        self.range.map_or(0.0, |(low, high)| high.max(-low))
    }

    /// Returns whether most values have digits that no percentage on a bus has.
    const fn is_fine(&self) -> bool {
        self.nonzero > 20 && self.fine > self.nonzero / 2
    }
}

/// Collects torque, friction, force and engine speed.
#[derive(Clone, Debug, Default)]
pub(super) struct Forces {
    torque: Sizes,
    friction: Sizes,
    force: Sizes,
    engine_speeds: u32,
    slow_engine_speeds: u32,
    fast_engine_speeds: u32,
    /// Engine speed over that of the gearbox's output shaft.
    ratios: Distribution,
}

impl Forces {
    /// Takes an engine torque, %.
    pub(super) fn torque(&mut self, percent: f64) {
        self.torque.add(percent);
    }

    /// Takes a friction torque, %.
    pub(super) fn friction(&mut self, percent: f64) {
        self.friction.add(percent);
    }

    /// Takes a traction force, N.
    pub(super) fn force(&mut self, newton: f64) {
        self.force.add(newton);
    }

    /// Takes an engine speed at a speed of the wheels.
    pub(super) fn engine_speed(&mut self, rpm: f64, mps: f64, vehicle: &VehicleParameters) {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return;
        };
        if mps < DRIVING_MPS || rpm < OFF_RPM {
            return;
        }
        let wheels_rpm = mps / f64::from(vehicle.wheel_radius_m) * 30.0 / PI;
        let shaft_rpm = wheels_rpm * f64::from(powertrain.final_drive_ratio);
        let (tallest, _) = gear_range(powertrain);
        self.engine_speeds = self.engine_speeds.saturating_add(1);
        let is_slow = rpm < IDLE_RPM && rpm < 0.5 * shaft_rpm * tallest;
        self.slow_engine_speeds += u32::from(is_slow);
        let fastest = if powertrain.reference_torque_nm >= TRUCK_NM {
            TRUCK_RPM
        } else {
            LARGEST_RPM
        };
        self.fast_engine_speeds += u32::from(rpm > fastest);
        self.ratios.add(rpm / shaft_rpm);
    }

    /// Returns what is not plausible after a way of the wheels, m.
    pub(super) fn judge(&self, way_m: f64, vehicle: &VehicleParameters, found: &mut Vec<Warning>) {
        if way_m < LEAST_M {
            return;
        }
        match &vehicle.traction {
            Traction::Powertrain(_) => {
                found.extend(self.torque_unit().or_else(|| self.friction_unit()));
                found.extend(self.engine_speed_unit());
            }
            Traction::Force => found.extend(self.force_unit(f64::from(vehicle.mass_kg))),
        }
    }

    fn torque_unit(&self) -> Option<Warning> {
        let torque = &self.torque;
        if torque.count < READINGS {
            return None;
        }
        let largest = torque.largest();
        let advice = "give the torque in % of the reference torque (column engine_torque_percent)";
        if torque.beyond > torque.count / 100 {
            return Some(Warning::major(
                "torque_unit",
                "the engine torque is not in %",
                format!("the engine torque reaches {largest:.0} %: it looks like Nm"),
                advice,
            ));
        }
        if largest <= SMALL_PERCENT && torque.is_fine() {
            return Some(Warning::major(
                "torque_unit",
                "the engine torque is not in %",
                format!(
                    "the engine torque never passes {largest:.2} %: it looks like a fraction, or kNm"
                ),
                advice,
            ));
        }
        let (low, high) = torque.range?;
        if low < TURNED_PERCENT && high <= SMALL_PERCENT {
            return Some(Warning::major(
                "torque_sign",
                "the engine torque has the wrong sign",
                format!(
                    "the engine torque goes down to {low:.0} % and never above {high:.0} %, so that the \
                     engine would only brake"
                ),
                "give the engine torque above zero where it drives (EEC1, SPN 513; column \
                 engine_torque_percent)",
            ));
        }
        (low == high).then(|| {
            Warning::major(
                "torque_constant",
                "the engine torque never changes",
                format!("the engine torque is always {low} %"),
                "check that the engine torque (EEC1, SPN 513; column engine_torque_percent) is that of \
                 the drive",
            )
        })
    }

    fn friction_unit(&self) -> Option<Warning> {
        let largest = self.friction.largest();
        let is_fraction = largest < SMALL_FRICTION_PERCENT && self.friction.is_fine();
        is_fraction.then(|| {
            Warning::minor(
                "friction_torque_unit",
                format!(
                    "the friction torque never passes {largest:.3} %: it looks like a fraction"
                ),
                "give the friction torque in % of the reference torque (column \
                 friction_torque_percent)",
            )
        })
    }

    fn force_unit(&self, mass_kg: f64) -> Option<Warning> {
        let force = &self.force;
        let largest_n = force.largest();
        let part = largest_n / (mass_kg * f64::from(GRAVITY));
        let looks = if part < SMALL_FORCE {
            "too little to keep rolling: it looks like kN"
        } else if part > LARGE_FORCE {
            "more than tyres can pass to a road"
        } else {
            return None;
        };
        (force.count >= READINGS).then(|| {
            Warning::major(
                "force_unit",
                "the traction force is not in N",
                format!("the largest traction force is {largest_n:.1} N, {looks}"),
                "give the traction force at the wheels in N (column traction_force_n), and the mass of \
                 the vehicle in kg",
            )
        })
    }

    fn engine_speed_unit(&self) -> Option<Warning> {
        let is_most = |count: u32| self.engine_speeds >= READINGS && count > self.engine_speeds / 2;
        let message = if is_most(self.slow_engine_speeds) {
            "the engine turns slower than any gear and any engine allows: its speed looks like \
             rad/s or 1/s"
        } else if is_most(self.fast_engine_speeds) {
            "the engine turns faster than engines do: its speed looks like °/s or raw numbers of the \
             bus"
        } else {
            return None;
        };
        Some(Warning::major(
            "engine_speed_unit",
            "the engine speed is not in rpm",
            message.to_owned(),
            "give the engine speed in rpm (column engine_speed_rpm): multiply rad/s by 9.5493",
        ))
    }

    /// Returns words on the ratios at which the engine turns, where engine speeds are known.
    pub(super) fn ratios(&self, powertrain: &Powertrain) -> String {
        let (least, largest) = gear_range(powertrain);
        let gears =
            format!("the gears of the vehicle file have ratios from {least:.2} to {largest:.2}");
        match (self.ratios.quantile(0.1), self.ratios.quantile(0.9)) {
            (Some(low), Some(high)) => format!(
                "the engine turns {low:.2} to {high:.2} times as fast as the gearbox's output \
                 shaft, and {gears}"
            ),
            _ => gears,
        }
    }
}

/// Returns the least and the largest ratio of the gears.
fn gear_range(powertrain: &Powertrain) -> (f64, f64) {
    let ratios = || powertrain.gears.iter().map(|gear| f64::from(gear.ratio));
    (
        ratios().fold(f64::INFINITY, f64::min),
        ratios().fold(0.0, f64::max),
    )
}
