//! A vehicle as bytes: in a controller's flash, and at the head of a recorded drive.
//!
//! | words | content                                                                              |
//! |-------|--------------------------------------------------------------------------------------|
//! | 2     | the bytes `RGDRIVE3`                                                                 |
//! | 5     | mass kg, drag area m², rolling resistance, wheel radius m, wheel inertia kg m²       |
//! | 1     | number of gears, or all ones for a measured traction force                           |
//! | 4     | engine inertia kg m², reference torque Nm, final drive ratio, final drive efficiency |
//! | 48    | ratio and efficiency of each gear                                                    |
//! | 6 × 32 | effects: number (`Effect::number`), or all ones for none; amount, its sigma, three parameters |
//!
//! Absent values are zero; an absent parameter of an effect is NaN. The number of an effect never
//! changes, so data outlive releases. Data with an effect that this release does not have are
//! refused. The estimator checks whether the vehicle is possible.

use crate::effect::{MAX_EFFECT_PARAMETERS, MAX_EFFECTS, numbered};
use crate::maybe::Maybe;
use crate::model::{AdoptedEffect, Model};
use crate::vehicle::{Gear, MAX_GEARS, Powertrain, Traction, VehicleParameters};
use crate::word_record::{halves, next_f32, next_u64, to_bytes, to_words};
use core::fmt;
use core::iter::repeat;

/// Number of effects that fit in. There is room for the effects of later releases.
const EFFECTS: usize = 32;
const _: () = assert!(MAX_EFFECTS <= EFFECTS);
/// Words before the effects.
const HEAD_WORDS: usize = 2 + 5 + 1 + 4 + 2 * MAX_GEARS;
const EFFECT_WORDS: usize = 3 + MAX_EFFECT_PARAMETERS;

/// Length of a packed vehicle, bytes.
pub const VEHICLE_BYTES: usize = 4 * (HEAD_WORDS + EFFECT_WORDS * EFFECTS);

const MAGIC: u64 = u64::from_le_bytes(*b"RGDRIVE3");
const MEASURED_FORCE: u32 = u32::MAX;
const NO_EFFECT: u32 = u32::MAX;

/// Why bytes are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackedVehicleError {
    /// The length is not [`VEHICLE_BYTES`].
    Length,
    /// The first bytes are not those of this version.
    Magic,
    /// There are more gears than a powertrain can have.
    Gears,
    /// This release has no effect of this number.
    Effect(u32),
    /// An effect occurs twice.
    Repeated,
}

impl fmt::Display for PackedVehicleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length => write!(f, "expected {VEHICLE_BYTES} bytes"),
            Self::Magic => f.write_str("expected a packed vehicle of version 3"),
            Self::Gears => write!(f, "expected at most {MAX_GEARS} gears"),
            Self::Effect(number) => write!(f, "effect {number} is unknown to this release"),
            Self::Repeated => f.write_str("an effect is given twice"),
        }
    }
}

impl core::error::Error for PackedVehicleError {}

/// Returns a vehicle as bytes.
#[must_use]
pub fn encode(model: &Model) -> [u8; VEHICLE_BYTES] {
    let vehicle = &model.vehicle;
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
    let effects = model.effects.iter().flat_map(effect_words);
    to_bytes(head.chain(effects).chain(repeat(NO_EFFECT)))
}

fn effect_words(adopted: &AdoptedEffect) -> [u32; EFFECT_WORDS] {
    let [first, second, third] = adopted
        .parameters
        .map(|parameter| parameter.get().unwrap_or(f32::NAN).to_bits());
    [
        adopted.effect.number.into(),
        adopted.amount.to_bits(),
        adopted.amount_sigma.to_bits(),
        first,
        second,
        third,
    ]
}

/// Returns the vehicle of these bytes.
///
/// # Errors
/// Returns [`PackedVehicleError`] if they are not a packed vehicle, or have an effect that this release lacks.
pub fn decode(bytes: &[u8]) -> Result<Model, PackedVehicleError> {
    let mut words = to_words(bytes, VEHICLE_BYTES).ok_or(PackedVehicleError::Length)?;
    if next_u64(&mut words) != Some(MAGIC) {
        return Err(PackedVehicleError::Magic);
    }
    let vehicle = vehicle(&mut words).ok_or(PackedVehicleError::Gears)?;
    let mut model = Model::from(vehicle);
    for _ in 0..EFFECTS {
        if let Some(adopted) = effect(&mut words)? {
            let is_known = model
                .effects
                .iter()
                .any(|known| known.effect == adopted.effect);
            if is_known || model.effects.adopt(adopted).is_err() {
                return Err(PackedVehicleError::Repeated);
            }
        }
    }
    Ok(model)
}

/// Reads the parameters; `None` if there are too many gears.
fn vehicle(words: &mut impl Iterator<Item = u32>) -> Option<VehicleParameters> {
    Some(VehicleParameters {
        mass_kg: next_f32(words)?,
        drag_area_m2: next_f32(words)?,
        rolling_resistance: next_f32(words)?,
        wheel_radius_m: next_f32(words)?,
        wheel_inertia_kgm2: next_f32(words)?,
        traction: {
            let gears = words.next()?;
            let mut words = words.take(4 + 2 * MAX_GEARS);
            let traction = match gears {
                MEASURED_FORCE => Traction::Force,
                gears => Traction::Powertrain(powertrain(gears, &mut words)?),
            };
            words.for_each(drop);
            traction
        },
    })
}

/// Reads the next effect; `Ok(None)` if there is none.
fn effect(
    words: &mut impl Iterator<Item = u32>,
) -> Result<Option<AdoptedEffect>, PackedVehicleError> {
    let number = words.next().ok_or(PackedVehicleError::Length)?;
    let mut next = || next_f32(words).ok_or(PackedVehicleError::Length);
    let [amount, amount_sigma] = [next()?, next()?];
    let parameters = [next()?, next()?, next()?].map(Maybe::some);
    if number == NO_EFFECT {
        return Ok(None);
    }
    Ok(Some(AdoptedEffect {
        effect: numbered(number).ok_or(PackedVehicleError::Effect(number))?,
        amount,
        amount_sigma,
        parameters,
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
