//! What logs must have for a vehicle to be identified, and what no vehicle is.

use super::identified::Identified;
use super::observation::Observation;
use crate::error::{Error, Result};
use estimator_core::Signal;
use std::path::Path;

/// Masses of road vehicles and their trains, kg.
const MASSES_KG: std::ops::RangeInclusive<f64> = 400.0..=150_000.0;
/// Way on which a gearbox with gears has steady ratios, m.
const STEADY_M: f64 = 2_000.0;

/// Returns an error for logs without a signal that an estimate needs.
pub(super) fn check_signals(first: &Path, observation: &Observation) -> Result<()> {
    let has = |signals: &[Signal]| signals.iter().any(|signal| observation.has(*signal));
    let missing = if !has(&[Signal::WheelSpeed]) {
        "no speed: expected wheel-based speed (CCVS1, PGN 65265; column wheel_speed_mps)"
    } else if !has(&[Signal::EngineTorque, Signal::TractionForce])
        && !observation.has_torque_in_nm()
    {
        "no torque: expected EEC1 (PGN 61444; column engine_torque_percent), or column \
         engine_torque_nm, motor_torque_nm or traction_force_n"
    } else if !has(&[Signal::Altitude]) {
        "no GNSS altitude: expected NMEA 2000 129029 (or VDS, PGN 65256; column altitude_m)"
    } else {
        return Ok(());
    };
    Err(Error::content(first, missing))
}

/// Returns why no gear was found.
pub(super) fn no_gears(observation: &Observation) -> &'static str {
    if !observation.has(Signal::EngineSpeed) {
        "no engine speed: expected EEC1 (PGN 61444; column engine_speed_rpm), which shows the gears"
    } else if observation.distance_m > STEADY_M {
        "engine and wheels never turn at a steady ratio: a gearbox with a continuously variable ratio, \
         or an engine that drives a generator; its torque at the wheels is not known: give a traction \
         force (column traction_force_n), or the motor's torque (motor_torque_nm)"
    } else {
        "no gear is ever engaged for a second of steady travel: expected a longer drive"
    }
}

/// Refuses a vehicle that no vehicle file may have, or that no road has.
pub(super) fn check_vehicle(first: &Path, found: &Identified) -> Result<()> {
    let model = &found.vehicle.model;
    let mass_kg = f64::from(model.vehicle.mass_kg);
    let problem = match model.check() {
        Err(problem) => problem.to_string(),
        Ok(()) if !MASSES_KG.contains(&mass_kg) => {
            format!("the mass comes out as {mass_kg:.0} kg, which no road vehicle has")
        }
        Ok(()) => return Ok(()),
    };
    let problem = format!(
        "not identifiable from these logs: {problem}; look at units and signs of torque, force and speed \
         (`roadgrade inspect` shows their ranges), give --vehicle, or more drives with hills"
    );
    Err(Error::content(first, problem))
}
