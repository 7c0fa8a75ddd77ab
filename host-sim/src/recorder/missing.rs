//! Inputs that a drive lacks for an estimate.

use super::long_run::LongRun;
use super::plausibility::Warning;
use crate::error::{Error, Result};
use crate::files::vehicle::VehicleFile;
use crate::source::read_options::ReadOptions;
use estimator_core::{Signal, Traction};
use std::path::Path;

/// Checks that a log was sufficient for an estimate.
///
/// # Errors
/// Returns an error that names the missing input.
pub fn check_inputs(
    log: &Path,
    vehicle: &VehicleFile,
    run: &LongRun,
    options: &ReadOptions,
) -> Result<()> {
    match missing(vehicle, run, &options.ignore) {
        Some(problem) => Err(Error::content(log, problem)),
        None => Ok(()),
    }
}

/// Returns the input that a drive lacks for an estimate; `None` if none is missing. Who ignores the
/// altitude does not miss it: the force balance alone gives a grade, with a large sigma.
#[must_use]
pub fn missing(vehicle: &VehicleFile, run: &LongRun, ignored: &[Signal]) -> Option<String> {
    let counters = &run.counters;
    let has_altitude = counters.altitudes_used > 0;
    let problem = if counters.speeds_used == 0 {
        "no speed: expected wheel-based speed (CCVS1, PGN 65265, or EBC2, PGN 65215; column \
         wheel_speed_mps)"
    } else if run.rows.count() == 0 {
        let mut causes = run.warnings.iter().filter(|of| of.spoils.is_some());
        if let Some(Warning {
            message, advice, ..
        }) = causes.next()
        {
            return Some(format!("no grade to estimate: {message}; {advice}"));
        }
        "the vehicle never moved: no grade to estimate"
    } else if counters.tractions_used == 0 {
        match vehicle.model.vehicle.traction {
            Traction::Powertrain(_) => {
                "no engine torque with a known gear: expected EEC1 (PGN 61444; column \
                 engine_torque_percent) and ETC2 (PGN 61445; column gear or gear_ratio) or engine \
                 speed"
            }
            Traction::Force => {
                "no traction force: expected column traction_force_n, as [traction] source = \
                 \"force\" in the vehicle file says"
            }
        }
    } else if !has_altitude && !ignored.contains(&Signal::Altitude) {
        "no GNSS altitude: expected NMEA 2000 129029 (or VDS, PGN 65256; column altitude_m); \
         --ignore altitude_m does without, with a larger sigma"
    } else {
        return None;
    };
    Some(problem.to_owned())
}
