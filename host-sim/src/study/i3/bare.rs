//! The climb by the force balance alone: no filter, no fit, no altitude.

use crate::diagnose::bare_model;
use crate::source::i3::TripRow;
use estimator_core::sample::ForceInputs;
use estimator_core::vehicle::{Driveline, Powertrain, Traction, VehicleParameters, air_density};

/// Longest step between two rows, s: beyond, there is a gap.
const LONGEST_STEP_S: f64 = 1.0;

/// Returns the climb since the first row, m, over time, s. Friction brakes count as climb. Rows
/// without speed or torque, and gaps, add nothing.
pub(super) fn climbs(rows: &[TripRow], vehicle: &VehicleParameters) -> Vec<(f64, f64)> {
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        return Vec::new();
    };
    let mut climb_m = 0.0;
    let mut climbs = Vec::with_capacity(rows.len());
    let mut last: Option<&TripRow> = None;
    for row in rows {
        climb_m += last
            .and_then(|last| climb_between(last, row, vehicle, powertrain))
            .unwrap_or(0.0);
        climbs.push((row.time_s, climb_m));
        last = Some(row);
    }
    climbs
}

fn climb_between(
    from: &TripRow,
    to: &TripRow,
    vehicle: &VehicleParameters,
    powertrain: &Powertrain,
) -> Option<f64> {
    let step_s = to.time_s - from.time_s;
    let (from_mps, to_mps) = (from.speed_mps?, to.speed_mps?);
    let way_m = 0.5 * (from_mps + to_mps) * step_s;
    if step_s > LONGEST_STEP_S || way_m <= 0.0 {
        return None;
    }
    let torque_nm = 0.5 * (from.motor_torque_nm? + to.motor_torque_nm?);
    let torque_percent = 100.0 * torque_nm / f64::from(powertrain.reference_torque_nm);
    let driveline = Driveline::Engaged(powertrain.only_gear()?);
    let radius_m = vehicle.wheel_radius_m;
    let balance = vehicle.force_balance(&ForceInputs {
        traction_n: vehicle.traction_n(driveline, torque_percent as f32, radius_m),
        rotating_kg: vehicle.rotating_kg(driveline, radius_m),
        mass_kg: vehicle.mass_kg,
        air_density: air_density(None, from.ambient_celsius.map(|celsius| celsius as f32)),
    });
    let energies = (0.5 * from_mps * from_mps, 0.5 * to_mps * to_mps);
    Some(0.01 * bare_model::slope_percent(&balance, 0.0, energies, way_m) * way_m)
}
