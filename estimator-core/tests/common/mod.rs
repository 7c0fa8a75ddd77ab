//! A vehicle and samples for tests.
#![allow(dead_code)]

use estimator_core::sampler::{AltitudeMeasurement, Sample, SpeedMeasurement};
use estimator_core::vehicle::Load;
use estimator_core::{
    CELL_LENGTH_M, Condition, Gear, Instant, Place, Powertrain, Traction, VehicleParameters,
};

/// A 39 t semi-trailer combination.
pub fn truck() -> VehicleParameters {
    let mut gears = heapless::Vec::new();
    for ratio in [11.3, 9.1, 7.1, 5.7, 4.5, 3.6, 2.9, 2.3, 1.8, 1.4, 1.0, 0.8] {
        gears
            .push(Gear {
                ratio,
                efficiency: 0.985,
            })
            .unwrap();
    }
    VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 6.0,
        rolling_resistance: 0.0065,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 100.0,
        traction: Traction::Powertrain(Powertrain {
            engine_inertia_kgm2: 3.8,
            reference_torque_nm: 1_750.0,
            final_drive_ratio: 2.92,
            final_drive_efficiency: 0.98,
            gears,
        }),
    }
}

/// A sample at cell `cell` with nothing measured.
pub fn sample(cell: u32, traction_n: f32, speed_mps: f32) -> Sample {
    let duration_s = CELL_LENGTH_M / speed_mps;
    Sample {
        place: Place {
            cell,
            time: Instant::from_micros((f64::from(cell) * f64::from(duration_s) * 1e6) as u64),
            position_e7: None,
            speed_mps,
            condition: Condition::default(),
        },
        gap_cells: 0,
        duration_s,
        load: Load {
            traction_n,
            rotating_kg: 500.0,
            mass_kg: 39_000.0,
            air_density: 1.2,
        },
        speed: None,
        altitude: None,
    }
}

/// A speed taken at the cell's end.
pub fn speed(mean_mps: f32) -> Option<SpeedMeasurement> {
    Some(SpeedMeasurement {
        mean_mps,
        behind_m: 0.0,
        count: 1,
    })
}

/// An altitude taken at the cell's end.
pub fn altitude(altitude_m: f32) -> Option<AltitudeMeasurement> {
    Some(AltitudeMeasurement {
        altitude_m,
        behind_m: 0.0,
        dilution: 1.0,
        source_switched: false,
    })
}
