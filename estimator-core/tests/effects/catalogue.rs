//! The catalogue: numbers of effects in stored data.

use estimator_core::effect::{self, CATALOGUE};

/// Numbers of the effects in stored data. Vehicle images in flash contain them, so a line here never
/// changes. A new effect gets a new line with the next free number.
const NUMBERS: [(&str, u8); 13] = [
    ("rolling_resistance", 0),
    ("tyre_warmup", 1),
    ("air_drag", 2),
    ("headwind", 3),
    ("cornering", 4),
    ("driveline_loss", 5),
    ("auxiliary_load", 6),
    ("mass", 7),
    ("torque_scale", 8),
    ("wheel_radius", 9),
    ("brake_drag", 10),
    ("road_surface", 11),
    ("tyre_temperature", 12),
];

#[test]
fn numbers_are_those_of_stored_data() {
    let mut found = CATALOGUE
        .map(|effect| (effect.name, effect.number))
        .to_vec();
    found.sort_by_key(|&(_, number)| number);
    assert_eq!(found, NUMBERS);
}

#[test]
fn numbers_are_unique_and_found() {
    for effect in CATALOGUE {
        let same = CATALOGUE
            .into_iter()
            .filter(|other| other.number == effect.number);
        assert_eq!(same.count(), 1, "{}", effect.name);
        assert_eq!(effect::numbered(effect.number.into()), Some(effect));
    }
}

#[test]
fn an_unknown_number_is_no_effect() {
    let is_known = |number: u32| NUMBERS.iter().any(|&(_, known)| u32::from(known) == number);
    // Beyond 255 as well: a number is not cut to its low byte.
    for number in (0..1_024).chain([u32::MAX, u32::MAX - 255]) {
        assert_eq!(
            effect::numbered(number).is_some(),
            is_known(number),
            "{number}"
        );
    }
}
