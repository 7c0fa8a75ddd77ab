//! The assumed parameters of the car.

use crate::files::vehicle::VehicleFile;
use estimator_core::{Gear, Model, Powertrain, Traction, VehicleParameters};

/// Mass of the car with two people and equipment, as on all trips, kg.
pub(super) const MASS_KG: f64 = 1_440.0;

/// Returns the assumed parameters of the car; nothing is fitted.
///
/// Mass (kerb, two people and equipment), drag area (2.38 m² frontal, cd 0.29), rolling resistance
/// (0.008 to 0.010), the radius of 155/70 R 19 and the single reduction of 9.665 are those published
/// of it. Its efficiency, and the rotor's inertia (about 0.06 kg m²), are those of such motors; the
/// inertia of the wheels is that of four of 0.9 kg m². The reference torque is the motor's largest.
#[must_use]
pub fn vehicle() -> VehicleFile {
    let reduction = Gear {
        ratio: 9.665,
        efficiency: 0.97,
    };
    let gears = std::iter::once(reduction).collect();
    VehicleFile {
        name: "BMW i3".to_owned(),
        model: Model::from(VehicleParameters {
            mass_kg: MASS_KG as f32,
            drag_area_m2: 0.69,
            rolling_resistance: 0.009,
            wheel_radius_m: 0.348,
            wheel_inertia_kgm2: 3.6,
            traction: Traction::Powertrain(Powertrain {
                engine_inertia_kgm2: 0.06,
                reference_torque_nm: 250.0,
                final_drive_ratio: 1.0,
                final_drive_efficiency: 1.0,
                gears,
            }),
        }),
    }
}
