//! The vehicle at the head of a drive.
//!
//! | words | content                                                                              |
//! |-------|--------------------------------------------------------------------------------------|
//! | 2     | the bytes `RGDRIVE2`                                                                 |
//! | 5     | mass kg, drag area m², rolling resistance, wheel radius m, wheel inertia kg m²       |
//! | 1     | number of gears, or all ones for a measured traction force                           |
//! | 4     | engine inertia kg m², reference torque Nm, final drive ratio, final drive efficiency |
//! | 48    | ratio and efficiency of each gear                                                    |
//! | 6 × 12 | effects: place in the catalogue, or all ones for none; amount, its sigma, three details |
//!
//! What a vehicle does not have is zero; a detail that is absent is no number. Whether the vehicle
//! can exist is for the estimator to check.

use super::{halves, next_f32, next_u64, to_bytes, to_words};
use core::iter::repeat;
use estimator_core::effect::{CATALOGUE, MAX_DETAILS, MAX_EFFECTS};
use estimator_core::vehicle::MAX_GEARS;
use estimator_core::{Adopted, Effects, Gear, Maybe, Powertrain, Traction, VehicleParameters};

/// Words before the effects.
const HEAD_WORDS: usize = 2 + 5 + 1 + 4 + 2 * MAX_GEARS;
const EFFECT_WORDS: usize = 3 + MAX_DETAILS;

/// Length of the header, bytes.
pub const VEHICLE_BYTES: usize = 4 * (HEAD_WORDS + EFFECT_WORDS * MAX_EFFECTS);

const MAGIC: u64 = u64::from_le_bytes(*b"RGDRIVE2");
const MEASURED_FORCE: u32 = u32::MAX;
const NO_EFFECT: u32 = u32::MAX;

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
    let (gears, powertrain) = match &vehicle.traction {
        Traction::Force => (MEASURED_FORCE, None),
        Traction::Powertrain(powertrain) => (powertrain.gears.len() as u32, Some(powertrain)),
    };
    let engine = powertrain.into_iter().flat_map(|powertrain| {
        let engine = [
            powertrain.engine_inertia_kgm2,
            powertrain.reference_torque_nm,
            powertrain.final_drive_ratio,
            powertrain.final_drive_efficiency,
        ];
        let gears = powertrain.gears.iter();
        engine
            .into_iter()
            .chain(gears.flat_map(|gear| [gear.ratio, gear.efficiency]))
    });
    let head = head.chain([gears]).chain(engine.map(f32::to_bits));
    let head = head.chain(repeat(0)).take(HEAD_WORDS);
    let effects = vehicle.effects.iter().flat_map(effect_words);
    to_bytes(head.chain(effects).chain(repeat(NO_EFFECT)))
}

fn effect_words(adopted: &Adopted) -> [u32; EFFECT_WORDS] {
    let place = CATALOGUE
        .iter()
        .position(|effect| *effect == adopted.effect);
    let [first, second, third] = adopted
        .details
        .map(|detail| detail.get().unwrap_or(f32::NAN).to_bits());
    [
        place.map_or(NO_EFFECT, |place| place as u32),
        adopted.amount.to_bits(),
        adopted.amount_sigma.to_bits(),
        first,
        second,
        third,
    ]
}

/// The vehicle of a header.
#[must_use]
pub fn decode(header: &[u8]) -> Option<VehicleParameters> {
    let mut words = to_words(header, VEHICLE_BYTES)?;
    if next_u64(&mut words)? != MAGIC {
        return None;
    }
    let mut vehicle = VehicleParameters {
        mass_kg: next_f32(&mut words)?,
        drag_area_m2: next_f32(&mut words)?,
        rolling_resistance: next_f32(&mut words)?,
        wheel_radius_m: next_f32(&mut words)?,
        wheel_inertia_kgm2: next_f32(&mut words)?,
        traction: {
            let gears = words.next()?;
            let mut words = words.by_ref().take(4 + 2 * MAX_GEARS);
            let traction = match gears {
                MEASURED_FORCE => Traction::Force,
                gears => Traction::Powertrain(powertrain(gears, &mut words)?),
            };
            words.for_each(drop);
            traction
        },
        effects: Effects::default(),
    };
    for _ in 0..MAX_EFFECTS {
        if let Some(adopted) = effect(&mut words)? {
            vehicle.effects.adopt(adopted).ok()?;
        }
    }
    Some(vehicle)
}

/// The next effect, or that there is none.
fn effect(words: &mut impl Iterator<Item = u32>) -> Option<Option<Adopted>> {
    let place = words.next()?;
    let numbers = [next_f32(words)?, next_f32(words)?];
    let details = [next_f32(words)?, next_f32(words)?, next_f32(words)?];
    if place == NO_EFFECT {
        return Some(None);
    }
    let [amount, amount_sigma] = numbers;
    Some(Some(Adopted {
        effect: CATALOGUE.get(place as usize)?,
        amount,
        amount_sigma,
        details: details.map(Maybe::some),
    }))
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
