//! A vehicle as bytes for a controller's flash: read back as it was, refused where it is damaged.

use estimator_core::effect::CATALOGUE;
use estimator_core::packed_vehicle::{PackedVehicleError, VEHICLE_BYTES, decode, encode};
use estimator_core::{AdoptedEffect, Model};
use test_kit::{by_force, truck};

/// Offsets in the bytes, from the table in the module's documentation.
const VERSION: usize = 7;
const MASS: usize = 8;
const GEARS: usize = 28;
const FIRST_EFFECT: usize = 240;
const EFFECT_BYTES: usize = 24;

fn with_effects() -> Model {
    let mut model = Model::from(truck());
    for effect in CATALOGUE {
        let adopted = AdoptedEffect::new(effect, effect.typical, 0.1);
        model.effects.adopt(adopted).unwrap();
    }
    model
}

fn edited(at: usize, word: u32) -> [u8; VEHICLE_BYTES] {
    let mut bytes = encode(&with_effects());
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    bytes
}

#[test]
fn a_vehicle_comes_back_as_it_was() {
    for model in [by_force().into(), truck().into(), with_effects()] {
        assert_eq!(decode(&encode(&model)), Ok(model));
    }
}

#[test]
fn bytes_stand_where_the_documentation_says() {
    let bytes = encode(&with_effects());
    assert_eq!(&bytes[..8], b"RGDRIVE3");
    assert_eq!(bytes[MASS..MASS + 4], truck().mass_kg.to_le_bytes());
    for (place, adopted) in with_effects().effects.iter().enumerate() {
        let at = FIRST_EFFECT + place * EFFECT_BYTES;
        let number = u32::from(adopted.effect.number);
        assert_eq!(bytes[at..at + 4], number.to_le_bytes());
        assert_eq!(bytes[at + 4..at + 8], adopted.amount.to_le_bytes());
    }
    let forced = encode(&by_force().into());
    assert_eq!(forced[GEARS..GEARS + 4], [0xff; 4]);
    assert_eq!(forced[FIRST_EFFECT..FIRST_EFFECT + 4], [0xff; 4]);
}

#[test]
fn damaged_bytes_are_refused_with_a_reason() {
    let good = encode(&with_effects());
    let second = edited(FIRST_EFFECT + EFFECT_BYTES, CATALOGUE[0].number.into());
    let mut earlier = good;
    earlier[VERSION] = b'2';
    for (bytes, refusal, words) in [
        (
            &good[1..],
            PackedVehicleError::Length,
            "expected 1008 bytes",
        ),
        (&[], PackedVehicleError::Length, "expected 1008 bytes"),
        (
            &earlier,
            PackedVehicleError::Magic,
            "expected a packed vehicle of version 3",
        ),
        (
            &edited(GEARS, 25),
            PackedVehicleError::Gears,
            "expected at most 24 gears",
        ),
        (
            &edited(GEARS, u32::MAX - 1),
            PackedVehicleError::Gears,
            "expected at most 24 gears",
        ),
        (
            &edited(FIRST_EFFECT, 250),
            PackedVehicleError::Effect(250),
            "effect 250 is unknown to this release",
        ),
        (
            &second,
            PackedVehicleError::Repeated,
            "an effect is given twice",
        ),
    ] {
        assert_eq!(decode(bytes), Err(refusal));
        assert_eq!(refusal.to_string(), words);
    }
    assert_eq!(good.len(), VEHICLE_BYTES);
}
