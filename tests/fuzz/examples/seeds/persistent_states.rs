//! States that a drive leaves, and damaged ones.

use crate::traffic::drive;
use estimator_core::{Estimator, Tuning};
use fuzz_targets::bus::EventBus;
use fuzz_targets::truck;

/// First byte of a seed: whether the target corrects the checksum.
const AS_IT_IS: u8 = 0;
const CORRECTED: u8 = 1;

pub fn of_persistent_state() -> Vec<(&'static str, Vec<u8>)> {
    let whole = left_by_a_drive();
    let seed = |corrects: u8, bytes: &[u8]| [&[corrects], bytes].concat();
    let with = |offset: usize, word: [u8; 4]| {
        let mut bytes = whole.clone();
        bytes[offset..offset + 4].copy_from_slice(&word);
        seed(CORRECTED, &bytes)
    };
    let mut damaged = whole.clone();
    damaged[20] ^= 0x10;
    vec![
        ("after_a_drive", seed(AS_IT_IS, &whole)),
        ("never_written", seed(AS_IT_IS, &vec![0xff; whole.len()])),
        ("cut_short", seed(AS_IT_IS, &whole[..whole.len() - 1])),
        (
            "a_byte_too_long",
            seed(AS_IT_IS, &[&whole[..], &[0]].concat()),
        ),
        ("damaged", seed(AS_IT_IS, &damaged)),
        ("of_something_else", with(0, *b"ELF\0")),
        ("of_a_later_version", with(4, 5_u32.to_le_bytes())),
        ("of_another_vehicle", with(8, [1, 2, 3, 4])),
        ("bias_not_a_number", with(16, f32::NAN.to_le_bytes())),
        ("variance_below_zero", with(20, (-1.0_f32).to_le_bytes())),
        ("correlation_above_one", with(32, 10.0_f32.to_le_bytes())),
        ("accelerometer", seed(CORRECTED, &of_accelerometer(&whole))),
        (
            "accelerometer_of_minus_zeros",
            with(48, (-0.0_f32).to_le_bytes()),
        ),
    ]
}

fn left_by_a_drive() -> Vec<u8> {
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).expect("a truck");
    let mut bus = EventBus::default();
    for _ in 0..10 {
        bus.play(&drive(2_000), &mut |timed| {
            estimator.on_frame(timed.time, &timed.frame);
            while estimator.step().is_some() {
                while estimator.next_cell().is_some() {}
            }
        });
    }
    estimator
        .persistent_state()
        .expect("a drive")
        .to_bytes()
        .to_vec()
}

/// Returns the state of a vehicle with an accelerometer.
fn of_accelerometer(whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let numbers = [0.1_f32, 4e-4, 0.05, 9e-4, 0.2];
    for (place, number) in bytes[48..].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}
