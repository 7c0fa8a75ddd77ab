//! Messages of inertial sensors and of electric motors, by hand.

use estimator_core::{Decoder, Reading, Signal, Value};
use test_kit::TestFrame;

/// Returns the only reading of a frame of this group.
fn only(pgn: u32, data: [u8; 8]) -> Reading {
    let mut readings = Vec::new();
    let frame = TestFrame::of_pgn(pgn, 0x0b, &data);
    Decoder::new().decode(&frame, |_, _, reading| readings.push(reading));
    let [reading] = readings[..] else {
        panic!("{readings:?}");
    };
    reading
}

fn assert_real(reading: Reading, signal: Signal, expected: f32) {
    assert_eq!(reading.signal, signal);
    let value = reading.value.real().unwrap();
    assert!((value - expected).abs() < 1e-4, "{signal:?} {value}");
}

/// An acceleration of 1.25 m/s² is raw 32,125, in ACCS; its figure of merit is in byte 7, bits 3-4.
fn accs(merit: u8) -> [u8; 8] {
    [0xff, 0xff, 0x7d, 0x7d, 0xff, 0xff, 0xf3 | merit << 2, 0xff]
}

/// A pitch of 2° is raw 33,000, in SSI; its figure of merit is in byte 7, bits 1-2.
fn ssi(merit: u8) -> [u8; 8] {
    [0xe8, 0x80, 0xff, 0xff, 0xff, 0xff, 0xfc | merit, 0xff]
}

/// A pitch of −3° is raw 8,093,696, in SSI2; its figure of merit is in byte 7, bits 3-4.
fn ssi2(merit: u8) -> [u8; 8] {
    [0x00, 0x80, 0x7b, 0xff, 0xff, 0xff, 0xf3 | merit << 2, 0xff]
}

#[test]
fn accelerations_pitches_and_pitch_rates() {
    let forward = Signal::LongitudinalAcceleration;
    assert_real(only(61_485, accs(0)), forward, 1.25);
    assert_real(only(61_459, ssi(0)), Signal::Pitch, 2.0);
    assert_real(only(61_481, ssi2(0)), Signal::Pitch, -3.0);
    // (2 + 250) times 128, in degrees a second.
    let ari = only(61_482, [0x00, 0x7e, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]);
    assert_real(ari, Signal::PitchRate, 2.0_f32.to_radians());
}

#[test]
fn the_stability_control_reports_acceleration_beside_yaw_rate() {
    // 2.5 m/s² in the last byte; the yaw rate is not available.
    let frame = TestFrame::of_pgn(61_449, 11, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 150]);
    let mut readings = Vec::new();
    Decoder::new().decode(&frame, |_, _, reading| readings.push(reading));
    let found = readings
        .iter()
        .find(|reading| reading.signal == Signal::LongitudinalAcceleration);
    assert!((found.unwrap().value.real().unwrap() - 2.5).abs() < 1e-5);
}

#[test]
fn what_a_sensor_calls_degraded_or_faulty_is_an_error() {
    type OfMerit = fn(u8) -> [u8; 8];
    let messages: [(u32, OfMerit); 3] = [(61_485, accs), (61_459, ssi), (61_481, ssi2)];
    for (pgn, of_merit) in messages {
        // 00 is fully functional; 11 is a sensor that does not judge itself.
        for (merit, is_good) in [(0, true), (1, false), (2, false), (3, true)] {
            let value = only(pgn, of_merit(merit)).value;
            assert_eq!(value.is_available(), is_good, "{pgn} {merit}");
            assert!(is_good || value == Value::Error, "{pgn} {merit}");
        }
        // What is not available is no error.
        let mut nothing = of_merit(1);
        nothing[..6].fill(0xff);
        assert_eq!(only(pgn, nothing).value, Value::NotAvailable, "{pgn}");
    }
}

#[test]
fn the_torque_of_a_motor_is_a_part_of_its_reference_torque() {
    // 12 bits from bit 5 of byte 2: (40 + 125) times 16, and (-20 + 125) times 16.
    for (high, percent) in [(0xa5, 40.0), (0x69, -20.0)] {
        let torque = only(64_372, [0xff, 0x0f, high, 0xff, 0xff, 0xff, 0xff, 0xff]);
        assert_real(torque, Signal::EngineTorque, percent);
    }
    // 1000 times 0.5 Nm.
    let reference = only(64_373, [0xff, 0xff, 0xe8, 0x03, 0xff, 0xff, 0xff, 0xff]);
    assert_real(reference, Signal::EngineReferenceTorque, 500.0);
}
