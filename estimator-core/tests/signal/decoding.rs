//! Frames to readings: values worked out by hand, codes, broken frames.

use estimator_core::signal::{FrameOutcome, Framing, Pgn, Rejection, encode, messages};
use estimator_core::{Decoder, Reading, Signal, Value};
use proptest::prelude::*;
use test_kit::{TestFrame, frames_of};

/// Parameter groups of the bus contract.
const MESSAGES: usize = 32;

fn decode(frames: &[TestFrame]) -> (Vec<Reading>, Vec<FrameOutcome>) {
    let mut decoder = Decoder::new();
    let mut readings = Vec::new();
    let outcomes = frames
        .iter()
        .map(|frame| decoder.decode(frame, |_, _, reading| readings.push(reading)))
        .collect();
    (readings, outcomes)
}

fn value(readings: &[Reading], signal: Signal) -> Value {
    readings.iter().find(|r| r.signal == signal).unwrap().value
}

fn real(readings: &[Reading], signal: Signal) -> f32 {
    value(readings, signal).real().unwrap()
}

#[test]
fn identifiers_come_apart_as_in_j1939_21() {
    // PDU2: the destination byte belongs to the number.
    assert_eq!(
        Pgn::from_raw(0x0CF0_0400),
        Pgn {
            number: 61_444,
            source: 0
        }
    );
    // PDU1: it does not (TP.DT to 255).
    assert_eq!(
        Pgn::from_raw(0x1CEB_FF03),
        Pgn {
            number: 60_160,
            source: 3
        }
    );
    // Data page 1: NMEA 2000.
    assert_eq!(
        Pgn::from_raw(0x0DF8_0523),
        Pgn {
            number: 129_029,
            source: 0x23
        }
    );
}

#[test]
fn every_group_of_the_contract_is_known() {
    let pgns: Vec<_> = messages().map(|message| message.pgn()).collect();
    let contract = [
        61_440, 61_441, 61_442, 61_444, 61_445, 61_449, 61_459, 61_481, 61_482, 61_485, 61_651,
        64_372, 64_373, 64_502, 64_872, 64_964, 64_992, 65_132, 65_136, 65_213, 65_215, 65_247,
        65_249, 65_251, 65_256, 65_265, 65_267, 65_269, 129_025, 129_026, 129_029, 129_539,
    ];
    assert_eq!(pgns, contract);
    assert_eq!(pgns.len(), MESSAGES);
}

#[test]
fn frames_of_other_groups_are_ignored() {
    let known: Vec<_> = messages().map(|message| message.pgn()).collect();
    let transport = [60_160, 60_416];
    let mut decoder = Decoder::new();
    // All groups of both data pages: those below F000 have a destination in their last byte.
    let groups = (0..0x2_0000).filter(|pgn| pgn & 0xff00 >= 0xf000 || pgn & 0xff == 0);
    let others = groups.filter(|pgn| !known.contains(pgn) && !transport.contains(pgn));
    let mut count = 0;
    for pgn in others {
        let frame = TestFrame::of_pgn(pgn, 3, &[0x11; 8]);
        let outcome = decoder.decode(&frame, |_, _, reading| panic!("{pgn}: {reading:?}"));
        assert_eq!(outcome, FrameOutcome::Ignored, "{pgn}");
        count += 1;
    }
    assert!(count > 8_000, "{count}");
}

#[test]
fn tools_are_told_how_each_message_is_sent() {
    let of = |pgn: u32| messages().find(|message| message.pgn() == pgn).unwrap();
    for (pgn, name, priority, length, framing) in [
        (61_444, "EEC1", 3, 8, Framing::Single),
        (65_251, "EC1", 6, 39, Framing::Transport),
        (129_029, "GnssPosition", 3, 43, Framing::FastPacket),
    ] {
        let message = of(pgn);
        assert_eq!((message.name(), message.priority()), (name, priority));
        assert_eq!((message.length(), message.framing()), (length, framing));
    }
}

#[test]
fn a_value_of_another_kind_is_sent_as_not_available() {
    for (pgn, wrong) in [
        (129_025, Value::Real(47.5)),
        (61_444, Value::DegreesE7(475_000_000)),
    ] {
        let mut payload = [0; 8];
        encode(pgn, &mut payload, |_| wrong).unwrap();
        let (readings, _) = decode(&[TestFrame::of_pgn(pgn, 0, &payload)]);
        assert!(readings.len() >= 2);
        for reading in readings {
            assert_eq!(reading.value, Value::NotAvailable, "{reading:?}");
        }
    }
}

#[test]
fn a_fast_packet_longer_than_any_message_is_read_from_its_begin() {
    let mut payload = vec![0xff; 43];
    payload[7..15].copy_from_slice(&(47_i64 * 10_i64.pow(16)).to_le_bytes());
    let (expected, _) = decode(&frames_of(129_029, 0x23, 1, &payload));
    let latitude = value(&expected, Signal::Latitude);
    assert_eq!(latitude, Value::DegreesE7(470_000_000));
    // As many bytes as a fast packet can have.
    payload.resize(223, 0x11);
    let (readings, outcomes) = decode(&frames_of(129_029, 0x23, 2, &payload));
    assert_eq!(readings, expected);
    assert_eq!(outcomes.len(), 32);
    assert!(matches!(outcomes[31], FrameOutcome::Decoded { .. }));
}

#[test]
fn engine_controller_by_hand() {
    // Mode 0, fraction 6 (0.75 %), torque 132 - 125 = 7 %, speed 0x1448 / 8 = 649 rpm.
    let frame = TestFrame::of_pgn(61_444, 0, &[0x60, 0x7d, 0x84, 0x48, 0x14, 0x00, 0xf0, 0x84]);
    let (readings, _) = decode(&[frame]);
    assert_eq!(real(&readings, Signal::EngineTorqueMode), 0.0);
    assert_eq!(real(&readings, Signal::EngineTorqueFraction), 0.75);
    assert_eq!(real(&readings, Signal::EngineTorque), 7.0);
    assert_eq!(real(&readings, Signal::EngineSpeed), 649.0);
}

#[test]
fn speed_and_switches_by_hand() {
    // 0x5000 / 256 = 80 km/h; brake switch on (bits 5-6 of byte 4), clutch not available.
    let frame = TestFrame::of_pgn(
        65_265,
        11,
        &[0xf3, 0x00, 0x50, 0xdf, 0xff, 0xff, 0xff, 0xff],
    );
    let (readings, _) = decode(&[frame]);
    assert!((real(&readings, Signal::WheelSpeed) - 80.0 / 3.6).abs() < 1e-5);
    assert_eq!(real(&readings, Signal::BrakeSwitch), 1.0);
    assert_eq!(value(&readings, Signal::ClutchSwitch), Value::NotAvailable);
    assert_eq!(real(&readings, Signal::ParkingBrake), 0.0);
}

#[test]
fn foundation_brake_and_tachograph_by_hand() {
    // Foundation brakes in use (byte 2, bits 1-2), emergency braking not available.
    let ebc5 = TestFrame::of_pgn(
        64_964,
        11,
        &[0xff, 0xfd, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
    );
    // 0x4b00 / 256 = 75 km/h in the last two bytes.
    let tco1 = TestFrame::of_pgn(
        65_132,
        0xee,
        &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00, 0x4b],
    );
    let (readings, _) = decode(&[ebc5, tco1]);
    assert_eq!(real(&readings, Signal::FoundationBrake), 1.0);
    assert!((real(&readings, Signal::TachographSpeed) - 75.0 / 3.6).abs() < 1e-5);
}

#[test]
fn weight_pressure_and_quality_of_the_newer_messages_by_hand() {
    // 19 500 times 2 kg, over three bytes.
    let gcvw = TestFrame::of_pgn(64_872, 0, &[0x2c, 0x4c, 0x00, 0xff, 0xff, 0xff, 0xff, 0xff]);
    // 987 times 0.1 kPa.
    let amb2 = TestFrame::of_pgn(64_992, 0, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xdb, 0x03]);
    // 11 satellites, HDOP 0.9, VDOP 1.4.
    let vp2 = TestFrame::of_pgn(64_502, 0x1c, &[11, 9, 14, 0xff, 0xff, 0xff, 0xff, 0xff]);
    // 140 / 8 - 16 = 1.5 %.
    let pcc1 = TestFrame::of_pgn(61_651, 0, &[0xff, 0xff, 0xff, 140, 0xff, 0xff, 0xff, 0xff]);
    let (readings, _) = decode(&[gcvw, amb2, vp2, pcc1]);
    for (signal, expected) in [
        (Signal::Mass, 39_000.0),
        (Signal::AirPressure, 98_700.0),
        (Signal::Satellites, 11.0),
        (Signal::Hdop, 0.9),
        (Signal::Vdop, 1.4),
        (Signal::RoadwayGrade, 1.5),
    ] {
        let value = real(&readings, signal);
        assert!(
            (value - expected).abs() <= 1e-6 * expected,
            "{signal:?} {value}"
        );
    }
}

#[test]
fn j1939_position_by_hand() {
    // (59.2 + 210) / 1e-7 = 2 692 000 000; (17.6 + 210) / 1e-7 = 2 276 000 000.
    let mut payload = 2_692_000_000_u32.to_le_bytes().to_vec();
    payload.extend(2_276_000_000_u32.to_le_bytes());
    let (readings, _) = decode(&[TestFrame::of_pgn(65_267, 1, &payload)]);
    assert_eq!(
        value(&readings, Signal::Latitude),
        Value::DegreesE7(592_000_000)
    );
    assert_eq!(
        value(&readings, Signal::Longitude),
        Value::DegreesE7(176_000_000)
    );
}

#[test]
fn gnss_position_by_hand() {
    let mut payload = [0xff_u8; 43];
    payload[7..15].copy_from_slice(&592_000_000_000_000_000_i64.to_le_bytes());
    payload[15..23].copy_from_slice(&(-176_000_000_000_000_000_i64).to_le_bytes());
    payload[23..31].copy_from_slice(&(-12_345_678_i64).to_le_bytes());
    payload[31] = 0x10; // GPS, method 1: GNSS fix
    payload[33] = 9;
    payload[34..36].copy_from_slice(&120_i16.to_le_bytes());
    let (readings, outcomes) = decode(&frames_of(129_029, 0x23, 5, &payload));
    assert_eq!(outcomes.len(), 7);
    assert!(matches!(
        outcomes[6],
        FrameOutcome::Decoded { source: 0x23, .. }
    ));
    assert_eq!(
        value(&readings, Signal::Latitude),
        Value::DegreesE7(592_000_000)
    );
    assert_eq!(
        value(&readings, Signal::Longitude),
        Value::DegreesE7(-176_000_000)
    );
    assert!((real(&readings, Signal::Altitude) + 12.345_678).abs() < 1e-5);
    assert_eq!(real(&readings, Signal::Satellites), 9.0);
    assert_eq!(real(&readings, Signal::FixMethod), 1.0);
    assert!((real(&readings, Signal::Hdop) - 1.2).abs() < 1e-6);
    assert_eq!(readings.last().unwrap().signal, Signal::Altitude);
}

#[test]
fn codes_are_no_measurements() {
    let with =
        |high: u8| TestFrame::of_pgn(65_265, 0, &[0xff, 0xff, high, 0xef, 0xff, 0xff, 0xff, 0xff]);
    let speed = |high| value(&decode(&[with(high)]).0, Signal::WheelSpeed);
    assert!(speed(0xfa).is_available());
    assert_eq!(speed(0xfb), Value::Error);
    assert_eq!(speed(0xfe), Value::Error);
    assert_eq!(speed(0xff), Value::NotAvailable);
    // Two bits: 10 is an error.
    assert_eq!(
        value(&decode(&[with(0)]).0, Signal::BrakeSwitch),
        Value::Error
    );
    // NMEA 2000: the largest three of a signed field.
    for (raw, expected) in [
        (0x7fff_ffff, Value::NotAvailable),
        (0x7fff_fffe, Value::Error),
        (-1, Value::NotAvailable),
        (-2, Value::DegreesE7(-2)),
    ] {
        let mut payload = i32::to_le_bytes(raw).to_vec();
        payload.extend(0_i32.to_le_bytes());
        let (readings, _) = decode(&[TestFrame::of_pgn(129_025, 0, &payload)]);
        assert_eq!(value(&readings, Signal::Latitude), expected);
        assert_eq!(value(&readings, Signal::Longitude), Value::DegreesE7(0));
    }
}

#[test]
fn bytes_that_are_all_ones_are_no_place() {
    for pgn in [129_025, 129_029] {
        let message = messages().find(|message| message.pgn() == pgn).unwrap();
        let payload = vec![0xff; message.length()];
        let (readings, _) = decode(&frames_of(pgn, 0, 0, &payload));
        assert!(readings.len() >= 2, "{pgn}");
        for reading in readings {
            assert!(!reading.value.is_available(), "{pgn}: {reading:?}");
        }
    }
}

#[test]
fn short_and_remote_frames_give_nothing() {
    let (readings, outcomes) = decode(&[TestFrame::of_pgn(61_444, 0, &[0, 0, 100])]);
    assert!(readings.is_empty());
    assert_eq!(outcomes, [FrameOutcome::Rejected(Rejection::Truncated)]);
    let remote = TestFrame {
        remote: true,
        ..TestFrame::of_pgn(61_444, 0, &[])
    };
    assert_eq!(
        decode(&[remote]).1,
        [FrameOutcome::Rejected(Rejection::Remote)]
    );
}

#[test]
fn eleven_bit_frames_are_not_ours() {
    let frame = TestFrame {
        id: embedded_can::StandardId::new(0x7e8).unwrap().into(),
        data: vec![0; 8],
        remote: false,
    };
    assert_eq!(decode(&[frame]).1, [FrameOutcome::Ignored]);
}

#[test]
fn a_fast_packet_with_a_hole_is_dropped_whole() {
    let payload = [0_u8; 43];
    for lost in 0..7 {
        let mut frames = frames_of(129_029, 1, 0, &payload);
        frames.remove(lost);
        let (readings, _) = decode(&frames);
        assert!(readings.is_empty(), "frame {lost} lost");
    }
    // The next one is whole again.
    let mut frames = frames_of(129_029, 1, 0, &payload);
    frames.remove(3);
    frames.extend(frames_of(129_029, 1, 1, &payload));
    assert!(!decode(&frames).0.is_empty());
}

#[test]
fn fast_packets_of_two_senders_interleave() {
    let payload = [0_u8; 43];
    let a = frames_of(129_029, 1, 0, &payload);
    let b = frames_of(129_029, 2, 0, &payload);
    let frames: Vec<_> = a.into_iter().zip(b).flat_map(|(a, b)| [a, b]).collect();
    let (_, outcomes) = decode(&frames);
    let whole = outcomes
        .iter()
        .filter(|o| matches!(o, FrameOutcome::Decoded { .. }));
    assert_eq!(whole.count(), 2);
}

proptest! {
    /// Every written value is read back within half a step of the coarsest field.
    #[test]
    fn encoding_and_decoding_agree(which in 0..MESSAGES, seeds in prop::collection::vec(0.0..1.0_f32, 8)) {
        let message = messages().nth(which).unwrap();
        let mut payload = [0_u8; 64];
        let signals: Vec<_> = message.signals().collect();
        let wanted = |signal: Signal| {
            let seed = seeds[signals.iter().position(|s| *s == signal).unwrap()];
            match signal {
                Signal::Latitude | Signal::Longitude => Value::DegreesE7((seed * 9e8) as i32),
                Signal::AirPressure => Value::Real(1e5 * seed),
                Signal::EngineTorqueFraction => Value::Real(0.875 * seed),
                Signal::YawRate | Signal::PitchRate => Value::Real(3.0 * (seed - 0.5)),
                Signal::LongitudinalAcceleration => Value::Real(20.0 * (seed - 0.5)),
                Signal::DrivelineEngaged | Signal::ShiftInProcess | Signal::BrakeSwitch
                | Signal::FoundationBrake | Signal::ParkingBrake | Signal::ClutchSwitch => Value::Real(seed.round()),
                Signal::FixMethod | Signal::EngineTorqueMode => Value::Real((13.0 * seed).round()),
                Signal::RoadwayGrade => Value::Real(30.0 * seed - 15.0),
                Signal::Hdop | Signal::Vdop => Value::Real(25.0 * seed),
                _ => Value::Real(60.0 * seed),
            }
        };
        let length = encode(message.pgn(), &mut payload, wanted).unwrap();
        let (readings, _) = decode(&frames_of(message.pgn(), 7, 2, &payload[..length]));
        prop_assert_eq!(readings.len(), signals.len());
        for reading in readings {
            match (reading.value, wanted(reading.signal)) {
                (Value::DegreesE7(a), Value::DegreesE7(b)) => prop_assert_eq!(a, b),
                (Value::Real(a), Value::Real(b)) => {
                    let step = match reading.signal {
                        Signal::Mass => 10.0,
                        Signal::AirPressure => 500.0,
                        _ => 1.0,
                    };
                    prop_assert!((a - b).abs() <= 0.5 * step + 1e-4, "{:?} {a} {b}", reading.signal);
                }
                (a, b) => prop_assert!(false, "{a:?} {b:?}"),
            }
        }
    }

    /// The codes of a missing value are written and read back.
    #[test]
    fn codes_survive_the_bus(which in 0..MESSAGES, error in any::<bool>()) {
        let message = messages().nth(which).unwrap();
        let code = if error { Value::Error } else { Value::NotAvailable };
        let mut payload = [0_u8; 64];
        let length = encode(message.pgn(), &mut payload, |_| code).unwrap();
        let (readings, _) = decode(&frames_of(message.pgn(), 7, 2, &payload[..length]));
        prop_assert!(readings.iter().all(|reading| reading.value == code));
    }

    /// No frame does harm, and no readings come from a frame that was not accepted.
    #[test]
    fn arbitrary_frames_do_no_harm(
        frames in prop::collection::vec(
            (0..MESSAGES, any::<u8>(), prop::collection::vec(any::<u8>(), 0..9), any::<bool>()), 0..60),
    ) {
        let mut decoder = Decoder::new();
        for (which, source, data, remote) in frames {
            let pgn = messages().nth(which).unwrap().pgn();
            let frame = TestFrame { remote, ..TestFrame::of_pgn(pgn, source, &data) };
            let mut count = 0;
            let outcome = decoder.decode(&frame, |_, _, _| count += 1);
            let decoded = matches!(outcome, FrameOutcome::Decoded { .. });
            prop_assert_eq!(count > 0, decoded);
        }
    }
}
