//! The vehicle at the head of a drive.
//!
//! | words | content                                                                              |
//! |-------|--------------------------------------------------------------------------------------|
//! | 2     | the bytes `RGDRIVE1`                                                                 |
//! | 5     | mass kg, drag area m², rolling resistance, wheel radius m, wheel inertia kg m²       |
//! | 1     | number of gears, or all ones for a measured traction force                           |
//! | 4     | engine inertia kg m², reference torque Nm, final drive ratio, final drive efficiency |
//! | 48    | ratio and efficiency of each gear                                                    |
//!
//! What a vehicle does not have is zero. Whether it can exist is for the estimator to check.

use super::{halves, next_f32, next_u64, to_bytes, to_words};
use estimator_core::vehicle::MAX_GEARS;
use estimator_core::{Gear, Powertrain, Traction, VehicleParameters};

/// Length of the header, bytes: that of ten frames.
pub const VEHICLE_BYTES: usize = 4 * (2 + 5 + 1 + 4 + 2 * MAX_GEARS);

const MAGIC: u64 = u64::from_le_bytes(*b"RGDRIVE1");
const MEASURED_FORCE: u32 = u32::MAX;

/// The header of a drive of this vehicle.
#[must_use]
pub fn encode(vehicle: &VehicleParameters) -> [u8; VEHICLE_BYTES] {
    let body = [
        vehicle.mass_kg,
        vehicle.drag_area_m2,
        vehicle.rolling_resistance,
        vehicle.wheel_radius_m,
        vehicle.wheel_inertia_kgm2,
    ];
    let head = halves(MAGIC).into_iter().chain(body.map(f32::to_bits));
    match &vehicle.traction {
        Traction::Force => to_bytes(head.chain([MEASURED_FORCE])),
        Traction::Powertrain(powertrain) => {
            let engine = [
                powertrain.engine_inertia_kgm2,
                powertrain.reference_torque_nm,
                powertrain.final_drive_ratio,
                powertrain.final_drive_efficiency,
            ];
            let gears = powertrain.gears.iter();
            to_bytes(
                head.chain([gears.len() as u32])
                    .chain(engine.map(f32::to_bits))
                    .chain(gears.flat_map(|gear| [gear.ratio, gear.efficiency].map(f32::to_bits))),
            )
        }
    }
}

/// The vehicle of a header.
#[must_use]
pub fn decode(header: &[u8]) -> Option<VehicleParameters> {
    let mut words = to_words(header, VEHICLE_BYTES)?;
    if next_u64(&mut words)? != MAGIC {
        return None;
    }
    Some(VehicleParameters {
        mass_kg: next_f32(&mut words)?,
        drag_area_m2: next_f32(&mut words)?,
        rolling_resistance: next_f32(&mut words)?,
        wheel_radius_m: next_f32(&mut words)?,
        wheel_inertia_kgm2: next_f32(&mut words)?,
        traction: match words.next()? {
            MEASURED_FORCE => Traction::Force,
            gears => Traction::Powertrain(powertrain(gears, &mut words)?),
        },
    })
}

fn powertrain(gears: u32, words: &mut impl Iterator<Item = u32>) -> Option<Powertrain> {
    let mut powertrain = Powertrain {
        engine_inertia_kgm2: next_f32(words)?,
        reference_torque_nm: next_f32(words)?,
        final_drive_ratio: next_f32(words)?,
        final_drive_efficiency: next_f32(words)?,
        gears: Default::default(),
    };
    for _ in 0..gears {
        let gear = Gear {
            ratio: next_f32(words)?,
            efficiency: next_f32(words)?,
        };
        powertrain.gears.push(gear).ok()?;
    }
    Some(powertrain)
}
