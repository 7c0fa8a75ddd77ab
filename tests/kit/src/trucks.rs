//! Vehicles.

use estimator_core::{Gear, Powertrain, Traction, VehicleParameters};

/// Returns a semi-trailer combination of 39 t with twelve gears.
#[must_use]
pub fn truck() -> VehicleParameters {
    let ratios = [11.3, 9.1, 7.1, 5.7, 4.5, 3.6, 2.9, 2.3, 1.8, 1.4, 1.0, 0.8];
    truck_with(1_750.0, &ratios)
}

/// Returns the same truck with an engine of this reference torque and these gear ratios, the first
/// gear first.
///
/// # Panics
/// Panics if there are more gears than a powertrain can have.
#[must_use]
pub fn truck_with(reference_torque_nm: f32, gear_ratios: &[f32]) -> VehicleParameters {
    let gear = |&ratio| Gear {
        ratio,
        efficiency: 0.985,
    };
    VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 6.0,
        rolling_resistance: 0.0065,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 100.0,
        traction: Traction::Powertrain(Powertrain {
            engine_inertia_kgm2: 3.8,
            reference_torque_nm,
            final_drive_ratio: 2.92,
            final_drive_efficiency: 0.98,
            gears: gear_ratios.iter().map(gear).collect(),
        }),
    }
}

/// Returns [`truck`] with measured traction force.
#[must_use]
pub fn by_force() -> VehicleParameters {
    VehicleParameters {
        traction: Traction::Force,
        ..truck()
    }
}
