//! The stored form of the persistent state: its bytes, and what is refused.

use estimator_core::tuning::Prior;
use estimator_core::{
    Estimator, Gear, PersistentState, PersistentStateError, Traction, Tuning, VehicleParameters,
};
use proptest::prelude::*;
use test_kit::by_force;
use test_kit::hilly_drive::{KEPT, USUAL, drive};
use test_kit::truck;

/// Lengths and offsets in the blob, from the table in the module's documentation.
const CHECKED: usize = 104;
const MASS: usize = 12;
const BIAS: usize = 16;
const BIAS_VARIANCE: usize = 20;
const SCALE: usize = 24;
const SCALE_VARIANCE: usize = 28;
const COVARIANCE: usize = 32;
const TYRE_SLIP_VARIANCE: usize = 40;
const RETARDER_VARIANCE: usize = 48;
const LEVELS: usize = 52;
const HIDES_BRAKES: usize = 76;
const DELAYS: usize = 80;

fn blob() -> [u8; PersistentState::LEN] {
    KEPT.to_bytes()
}

/// CRC-32 bit by bit: polynomial 0x04C11DB7, reflected.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// Returns the blob with these four bytes replaced, and its checksum.
fn edited(at: usize, word: [u8; 4]) -> [u8; PersistentState::LEN] {
    edited_words(&blob(), &[(at, word)])
}

fn edited_words(
    blob: &[u8; PersistentState::LEN],
    words: &[(usize, [u8; 4])],
) -> [u8; PersistentState::LEN] {
    let mut bytes = *blob;
    for (at, word) in words {
        bytes[*at..at + 4].copy_from_slice(word);
    }
    let checksum = crc32(&bytes[..CHECKED]);
    bytes[CHECKED..].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

#[test]
fn a_state_tells_the_mass_that_its_scale_stands_for() {
    let slow = KEPT.slow_states();
    let scale = 1.0 + slow.scale.mean;
    let mass_kg = 39_000.0 / scale;
    let part = slow.scale.variance.sqrt() / scale;
    let tuning = Prior::default();
    let by_force = KEPT.mass_kg(&by_force().into(), &tuning);
    assert!((by_force.value / mass_kg - 1.0).abs() < 1e-5);
    assert!((by_force.sigma / (mass_kg * part) - 1.0).abs() < 1e-4);
    // An engine's torque is right within 4 %.
    let by_torque = KEPT.mass_kg(&truck().into(), &tuning);
    assert_eq!(by_torque.value, by_force.value);
    assert!((by_torque.sigma / (mass_kg * part.hypot(0.04)) - 1.0).abs() < 1e-4);
}

#[test]
fn a_blob_is_as_documented_and_reads_back() {
    let bytes = blob();
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let slow = KEPT.slow_states();
    assert_eq!(bytes[..8], *b"rgk\x1a\x05\0\0\0");
    assert_eq!(number(MASS), 39_000.0);
    assert_eq!(number(BIAS), slow.bias.mean);
    assert_eq!(number(BIAS_VARIANCE), slow.bias.variance);
    assert_eq!(number(SCALE), slow.scale.mean);
    assert_eq!(number(SCALE_VARIANCE), slow.scale.variance);
    assert_eq!(number(COVARIANCE), slow.covariance);
    assert_eq!(number(TYRE_SLIP_VARIANCE), slow.tyre_slip.variance);
    assert_eq!(number(RETARDER_VARIANCE), slow.retarder.variance);
    assert_eq!(number(LEVELS), KEPT.levels().force);
    assert_eq!(number(LEVELS + 20), KEPT.levels().speed);
    assert_eq!(bytes[HIDES_BRAKES..DELAYS], [0; 4]);
    // No delay was found.
    assert_eq!(bytes[DELAYS..CHECKED], [0; 24]);
    assert_eq!(bytes[CHECKED..], crc32(&bytes[..CHECKED]).to_le_bytes());
    assert_eq!(PersistentState::LEN, CHECKED + 4);
    assert_eq!(PersistentState::from_bytes(&bytes), Ok(*KEPT));
}

#[test]
fn each_flipped_bit_is_refused() {
    for bit in 0..8 * PersistentState::LEN {
        let mut bytes = blob();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let refusal = PersistentState::from_bytes(&bytes).unwrap_err();
        match bit / 8 {
            0..4 => assert_eq!(refusal, PersistentStateError::Magic),
            4..8 => assert!(
                matches!(refusal, PersistentStateError::Version(_)),
                "{refusal:?}"
            ),
            _ => assert_eq!(refusal, PersistentStateError::Checksum, "bit {bit}"),
        }
    }
}

#[test]
fn each_wrong_length_is_refused() {
    let bytes = blob();
    for length in 0..PersistentState::LEN {
        let refusal = PersistentState::from_bytes(&bytes[..length]);
        assert_eq!(refusal, Err(PersistentStateError::Length(length)));
    }
    for more in 1..9 {
        let longer = [&bytes[..], &vec![0; more]].concat();
        let refusal = PersistentState::from_bytes(&longer);
        assert_eq!(
            refusal,
            Err(PersistentStateError::Length(PersistentState::LEN + more))
        );
    }
    // Memory that was never written, or erased.
    assert_eq!(
        PersistentState::from_bytes(&[0xff; PersistentState::LEN]),
        Err(PersistentStateError::Magic)
    );
    assert_eq!(
        PersistentState::from_bytes(&[0; PersistentState::LEN]),
        Err(PersistentStateError::Magic)
    );
    // A later layout, of another length and with a right checksum.
    let later = &edited(4, 6_u32.to_le_bytes())[..];
    assert_eq!(
        PersistentState::from_bytes(later),
        Err(PersistentStateError::Version(6))
    );
    let later = [later, &[0; 8]].concat();
    assert_eq!(
        PersistentState::from_bytes(&later),
        Err(PersistentStateError::Version(6))
    );
}

#[test]
fn numbers_that_no_drive_leaves_are_refused_under_a_right_checksum() {
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30];
    for at in (MASS..HIDES_BRAKES).chain(DELAYS..CHECKED).step_by(4) {
        for number in numbers {
            let refusal = PersistentState::from_bytes(&edited(at, number.to_le_bytes()));
            assert_eq!(
                refusal,
                Err(PersistentStateError::Value),
                "{number} at {at}"
            );
        }
    }
    // A variance or a mass is positive.
    let positive = [
        MASS,
        BIAS_VARIANCE,
        SCALE_VARIANCE,
        TYRE_SLIP_VARIANCE,
        RETARDER_VARIANCE,
    ];
    for at in positive
        .into_iter()
        .chain((LEVELS..HIDES_BRAKES).step_by(4))
    {
        for number in [0.0_f32, -0.01, f32::from_bits(1)] {
            let refusal = PersistentState::from_bytes(&edited(at, number.to_le_bytes()));
            assert_eq!(
                refusal,
                Err(PersistentStateError::Value),
                "{number} at {at}"
            );
        }
    }
    // No traction at all; more correlation than there can be.
    let slow = KEPT.slow_states();
    let most = (slow.bias.variance * slow.scale.variance).sqrt();
    for (at, number) in [
        (SCALE, -1.0),
        (COVARIANCE, 1.1 * most),
        (COVARIANCE, -1.1 * most),
    ] {
        let refusal = PersistentState::from_bytes(&edited(at, number.to_le_bytes()));
        assert_eq!(
            refusal,
            Err(PersistentStateError::Value),
            "{number} at {at}"
        );
    }
    // A delay without a sigma, or one that no receiver has.
    let delayed = |seconds: f32, sigma_s: f32| {
        [
            (DELAYS, seconds.to_le_bytes()),
            (DELAYS + 4, sigma_s.to_le_bytes()),
        ]
    };
    for (seconds, sigma_s) in [(0.6, 0.0), (0.6, -0.1), (60.0, 0.01), (-5.0, 0.01)] {
        let refusal =
            PersistentState::from_bytes(&edited_words(&blob(), &delayed(seconds, sigma_s)));
        assert_eq!(refusal, Err(PersistentStateError::Value), "{seconds} s");
    }
    for (at, number) in [(SCALE, 0.1_f32), (COVARIANCE, 0.9 * most), (BIAS, -1.0)] {
        assert!(PersistentState::from_bytes(&edited(at, number.to_le_bytes())).is_ok());
    }
}

proptest! {
    /// Bytes that were not written by this library are refused.
    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..120)) {
        prop_assert!(PersistentState::from_bytes(&bytes).is_err());
    }

    #[test]
    fn any_content_under_a_right_checksum_is_refused_or_sound(
        numbers in prop::collection::vec((3..25_usize, -9.9..9.9_f32, -12..5), 1..4),
        metres in 100..600_u32,
    ) {
        let mut bytes = blob();
        for (index, mantissa, exponent) in numbers {
            // All but the flag, which is no number.
            let index = if 4 * index < HIDES_BRAKES { index } else { index + 1 };
            let (at, number) = (4 * index, mantissa * 10_f32.powi(exponent));
            bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        }
        let checksum = crc32(&bytes[..CHECKED]);
        bytes[CHECKED..].copy_from_slice(&checksum.to_le_bytes());
        let Ok(state) = PersistentState::from_bytes(&bytes) else {
            return Ok(());
        };
        prop_assert_eq!(state.to_bytes(), bytes);
        let estimator = Estimator::<f32>::restore(by_force(), Tuning::default(), &state);
        let estimator = drive(estimator.unwrap(), metres, USUAL);
        prop_assert_eq!(estimator.counters().restarts, 0);
        prop_assert!(estimator.live().unwrap().estimate.grade_percent.value.is_finite());
    }

    /// Several damaged bytes in a row, as an interrupted write leaves them.
    #[test]
    fn a_torn_write_is_refused(cut in 1..PersistentState::LEN, rest in any::<u8>()) {
        let mut bytes = blob();
        bytes[cut..].fill(rest);
        prop_assume!(bytes != blob());
        prop_assert!(PersistentState::from_bytes(&bytes).is_err());
    }
}

#[test]
fn another_vehicle_or_an_edited_one_is_refused() {
    fn restore(
        vehicle: VehicleParameters,
        state: &PersistentState,
    ) -> Result<(), PersistentStateError> {
        Estimator::<f32>::restore(vehicle, Tuning::default(), state).map(drop)
    }
    assert_eq!(restore(by_force(), &KEPT), Ok(()));
    assert_eq!(restore(truck(), &KEPT), Err(PersistentStateError::Vehicle));

    let edits: [fn(&mut VehicleParameters); 5] = [
        |vehicle| vehicle.mass_kg += 10.0,
        |vehicle| vehicle.drag_area_m2 += 0.01,
        |vehicle| vehicle.rolling_resistance += 1e-5,
        |vehicle| vehicle.wheel_radius_m += 0.001,
        |vehicle| vehicle.wheel_inertia_kgm2 += 1.0,
    ];
    for edit in edits {
        let mut vehicle = by_force();
        edit(&mut vehicle);
        assert_eq!(restore(vehicle, &KEPT), Err(PersistentStateError::Vehicle));
    }

    let powered =
        PersistentState::from_bytes(&edited(8, fingerprint_of(&truck()).to_le_bytes())).unwrap();
    assert_eq!(restore(truck(), &powered), Ok(()));
    let edits: [fn(&mut estimator_core::Powertrain); 8] = [
        |powertrain| powertrain.engine_inertia_kgm2 += 0.1,
        |powertrain| powertrain.reference_torque_nm += 10.0,
        |powertrain| powertrain.final_drive_ratio += 0.01,
        |powertrain| powertrain.final_drive_efficiency -= 0.01,
        |powertrain| powertrain.gears[3].ratio += 0.01,
        |powertrain| powertrain.gears[11].efficiency -= 0.01,
        |powertrain| powertrain.gears.truncate(11),
        |powertrain| {
            let lowest = Gear {
                ratio: 15.0,
                efficiency: 0.985,
            };
            powertrain.gears.insert(0, lowest).unwrap();
        },
    ];
    for edit in edits {
        let mut vehicle = truck();
        let Traction::Powertrain(powertrain) = &mut vehicle.traction else {
            unreachable!("it has one");
        };
        edit(powertrain);
        assert_eq!(
            restore(vehicle, &powered),
            Err(PersistentStateError::Vehicle)
        );
    }

    let impossible = VehicleParameters {
        mass_kg: f32::NAN,
        ..by_force()
    };
    let refusal = restore(impossible, &KEPT).unwrap_err();
    assert!(
        matches!(refusal, PersistentStateError::Parameter(error) if error.key == "vehicle.mass_kg")
    );
}

/// Returns CRC-32 over the parameters in order, as the module's documentation says.
fn fingerprint_of(vehicle: &VehicleParameters) -> u32 {
    let mut numbers = vec![
        vehicle.mass_kg,
        vehicle.drag_area_m2,
        vehicle.rolling_resistance,
        vehicle.wheel_radius_m,
        vehicle.wheel_inertia_kgm2,
    ];
    if let Traction::Powertrain(powertrain) = &vehicle.traction {
        numbers.extend([
            powertrain.engine_inertia_kgm2,
            powertrain.reference_torque_nm,
            powertrain.final_drive_ratio,
            powertrain.final_drive_efficiency,
        ]);
        let gears = powertrain.gears.iter();
        numbers.extend(gears.flat_map(|gear| [gear.ratio, gear.efficiency]));
    }
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    crc32(&bytes)
}

#[test]
fn refusals_say_what_is_wrong() {
    for (refusal, words) in [
        (PersistentStateError::Length(3), "3 bytes: expected 108"),
        (PersistentStateError::Version(7), "version 7: expected 5"),
        (PersistentStateError::Checksum, "damaged"),
        (PersistentStateError::Vehicle, "another vehicle"),
    ] {
        assert!(refusal.to_string().contains(words), "{refusal}");
    }
}
