//! Altitude drift of the bare vehicle model: no GNSS, no filter, no fit.

use crate::diagnose::bare_model;
use estimator_core::sample::ForceInputs;
use estimator_core::vehicle::{Driveline, VehicleParameters, air_density};

/// The signals of one row of a signal table that the force balance uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSample {
    /// Time, s.
    pub time_s: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Force at the wheels, N.
    pub traction_force_n: f64,
    /// Mass, kg; `None` for the vehicle's parameter.
    pub mass_kg: Option<f64>,
    /// Air temperature, °C. The air density is the standard one unless the pressure is known as
    /// well.
    pub ambient_celsius: Option<f64>,
    /// Air pressure, Pa.
    pub air_pressure_pa: Option<f64>,
}

/// Drift of the bare vehicle model over a section of road.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ModelDrift {
    /// Distance driven, m.
    pub length_m: f64,
    /// Altitude gain according to the model, m.
    pub modelled_climb_m: f64,
    /// Modelled minus true altitude gain, per km of distance.
    pub drift_m_per_km: f64,
    /// The same as a mean grade error, %.
    pub grade_error_percent: f64,
}

/// Integrates the pointwise grade of the force balance (thesis eq. 9, solved for the slope) over
/// the distance, and compares it with the true altitude gain `climb_m`. That gain is 0 for complete
/// round trips.
///
/// Between two rows the speed is linear in time and the force is their mean, as in the core's
/// sampler. The model has no friction brakes: their work counts as climb. Returns `None` if the
/// vehicle does not move.
#[must_use]
pub fn vehicle_model_drift(
    samples: &[ForceSample],
    vehicle: &VehicleParameters,
    climb_m: f64,
) -> Option<ModelDrift> {
    let mut length_m = 0.0;
    let mut modelled_climb_m = 0.0;
    for two in samples.windows(2) {
        let (from, to) = (&two[0], &two[1]);
        let way_m = 0.5 * (from.speed_mps + to.speed_mps) * (to.time_s - from.time_s);
        if way_m > 0.0 {
            length_m += way_m;
            modelled_climb_m += 0.01 * slope_percent(from, to, way_m, vehicle) * way_m;
        }
    }
    let drift_m = modelled_climb_m - climb_m;
    (length_m > 0.0).then(|| ModelDrift {
        length_m,
        modelled_climb_m,
        drift_m_per_km: 1000.0 * drift_m / length_m,
        grade_error_percent: 100.0 * drift_m / length_m,
    })
}

/// Returns the sine of the slope between two rows, %.
fn slope_percent(
    from: &ForceSample,
    to: &ForceSample,
    way_m: f64,
    vehicle: &VehicleParameters,
) -> f64 {
    let real = |value: Option<f64>| value.map(|v| v as f32);
    let balance = vehicle.force_balance(&ForceInputs {
        traction_n: (0.5 * (from.traction_force_n + to.traction_force_n)) as f32,
        rotating_kg: vehicle.rotating_kg(Driveline::Open, vehicle.wheel_radius_m),
        mass_kg: real(from.mass_kg).unwrap_or(vehicle.mass_kg),
        air_density: air_density(real(from.air_pressure_pa), real(from.ambient_celsius)),
    });
    let energies = (0.5 * from.speed_mps.powi(2), 0.5 * to.speed_mps.powi(2));
    bare_model::slope_percent(&balance, 0.0, energies, way_m)
}
