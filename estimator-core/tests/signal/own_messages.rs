//! Messages of a user's own `.dbc`: numbers in both byte orders, multiplexers, codes, and signals that
//! go before those of built-in messages.

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::signal::encode;
use estimator_core::signal::own_message::{
    FrameMatch, Multiplexer, OwnMessage, OwnSignal, decode_own,
};
use estimator_core::signal::raw_field::ByteOrder::{self, Intel, Motorola};
use estimator_core::signal::raw_field::NumberKind::{self, Float32, Float64, Signed, Unsigned};
use estimator_core::signal::raw_field::{RawField, RawNumber};
use estimator_core::{Estimator, Instant, Outcome, Reading, Signal, Tuning, Value};
use proptest::prelude::*;
use test_kit::{TestFrame, truck};

fn field(start_bit: u16, bits: u8, order: ByteOrder, kind: NumberKind) -> RawField {
    RawField::new(start_bit, bits, order, kind).unwrap()
}

fn own(signal: Signal, field: RawField, scale: f64, offset: f64) -> OwnSignal<'static> {
    OwnSignal {
        signal,
        field,
        multiplexers: &[],
        scale,
        offset,
        invalid: &[],
        values: &[],
        has_j1939_codes: false,
    }
}

/// Writes a number bit by bit, as the description of the format goes: Intel upward from the least
/// significant bit, Motorola downward from the most significant one, on to bit 7 of the next byte.
fn write(payload: &mut [u8], start_bit: u16, bits: u8, order: ByteOrder, number: u64) {
    let mut bit = usize::from(start_bit);
    for k in 0..bits {
        let place = if order == Intel { k } else { bits - 1 - k };
        let mask = 1 << (bit % 8);
        payload[bit / 8] &= !mask;
        if number >> place & 1 == 1 {
            payload[bit / 8] |= mask;
        }
        bit = match order {
            Intel => bit + 1,
            Motorola if bit.is_multiple_of(8) => bit + 15,
            Motorola => bit - 1,
        };
    }
}

fn end_of(start_bit: u16, bits: u8, order: ByteOrder) -> usize {
    let before = match order {
        Intel => start_bit % 8,
        Motorola => 7 - start_bit % 8,
    };
    usize::from(start_bit / 8 * 8 + before + u16::from(bits))
}

proptest! {
    #[test]
    fn what_is_written_bit_by_bit_is_read(
        start_bit in 0_u16..64,
        bits in 1_u8..=64,
        is_intel: bool,
        number: u64,
        around: [u8; 8],
    ) {
        let order = if is_intel { Intel } else { Motorola };
        prop_assume!(end_of(start_bit, bits, order) <= 64);
        let number = number >> (64 - bits);
        let mut payload = around;
        write(&mut payload, start_bit, bits, order, number);
        let unsigned = field(start_bit, bits, order, Unsigned);
        prop_assert_eq!(unsigned.read(&payload), Some(RawNumber::Unsigned(number)));
        let signed = (number << (64 - bits)) as i64 >> (64 - bits);
        let field = field(start_bit, bits, order, Signed);
        prop_assert_eq!(field.read(&payload), Some(RawNumber::Signed(signed)));
        // One byte less, and it is not there.
        let shorter = &payload[..field.payload_bytes() - 1];
        prop_assert_eq!(field.read(shorter), None);
    }

    #[test]
    fn floating_point_numbers_are_read(
        start_bit in 0_u16..8,
        single: f32,
        double: f64,
    ) {
        for (order, start) in [(Intel, start_bit), (Motorola, 7 - start_bit)] {
            let mut payload = [0; 9];
            write(&mut payload, start, 32, order, single.to_bits().into());
            let read = field(start, 32, order, Float32).read(&payload);
            prop_assert_eq!(read, Some(RawNumber::Real(single.into())));
            write(&mut payload, start, 64, order, double.to_bits());
            let read = field(start, 64, order, Float64).read(&payload);
            prop_assert_eq!(read, Some(RawNumber::Real(double)));
        }
    }
}

#[test]
fn known_payloads_are_read() {
    // The example of cantools, motohawk.dbc: radius 3.2 m, temperature 250.55 K, enabled.
    let payload = [0xc0, 0x06, 0xe0, 0, 0, 0, 0, 0];
    let radius = field(6, 6, Motorola, Unsigned);
    assert_eq!(radius.read(&payload), Some(RawNumber::Unsigned(32)));
    let temperature = field(0, 12, Motorola, Signed);
    assert_eq!(temperature.read(&payload), Some(RawNumber::Signed(55)));
    // EEC1's engine speed, of 1,500 rpm.
    let payload = [0xf0, 0xff, 0x8c, 0xe0, 0x2e, 0xff, 0xff, 0xff];
    let speed = field(24, 16, Intel, Unsigned);
    assert_eq!(speed.read(&payload), Some(RawNumber::Unsigned(12_000)));
}

#[test]
fn impossible_fields_are_none() {
    for (bits, kind) in [
        (0, Unsigned),
        (65, Signed),
        (16, Float32),
        (32, Float64),
        (255, Unsigned),
    ] {
        assert_eq!(RawField::new(0, bits, Intel, kind), None, "{bits} {kind:?}");
    }
}

#[test]
fn codes_and_values_of_raw_numbers_go_before_the_scale() {
    let gear = OwnSignal {
        invalid: &[15],
        values: &[(7, -1.0)],
        ..own(Signal::CurrentGear, field(0, 4, Intel, Unsigned), 1.0, 0.0)
    };
    assert_eq!(gear.read(&[3]), Some(Value::Real(3.0)));
    assert_eq!(gear.read(&[7]), Some(Value::Real(-1.0)));
    assert_eq!(gear.read(&[15]), Some(Value::NotAvailable));
    assert_eq!(gear.read(&[]), None);
}

#[test]
fn codes_of_signed_and_floating_point_numbers_are_compared_as_such() {
    for (kind, minus_one, one) in [
        (Signed, (-1_i32).to_le_bytes(), 1_i32.to_le_bytes()),
        (Float32, (-1.0_f32).to_le_bytes(), 1.0_f32.to_le_bytes()),
    ] {
        let raw = field(0, 32, Intel, kind);
        assert_eq!(raw.kind(), kind);
        let altitude = OwnSignal {
            invalid: &[-1],
            ..own(Signal::Altitude, raw, 2.0, 0.0)
        };
        assert_eq!(altitude.read(&minus_one), Some(Value::NotAvailable));
        assert_eq!(altitude.read(&one), Some(Value::Real(2.0)));
    }
}

#[test]
fn numbers_that_no_signal_has_are_errors() {
    let speed = own(Signal::WheelSpeed, field(0, 32, Intel, Float32), 1.0, 0.0);
    for (number, value) in [
        (f32::NAN, Value::Error),
        (f32::INFINITY, Value::Error),
        (12.5, Value::Real(12.5)),
    ] {
        assert_eq!(speed.read(&number.to_le_bytes()), Some(value), "{number}");
    }
    let latitude = own(Signal::Latitude, field(0, 32, Intel, Signed), 1e-7, 0.0);
    for (raw, value) in [
        (473_769_123_i32, Value::DegreesE7(473_769_123)),
        (-900_000_000, Value::DegreesE7(-900_000_000)),
        (900_000_001, Value::Error),
    ] {
        assert_eq!(latitude.read(&raw.to_le_bytes()), Some(value), "{raw}");
    }
    let longitude = own(Signal::Longitude, field(0, 32, Intel, Signed), 1e-7, 0.0);
    for (raw, value) in [
        (-1_800_000_000_i32, Value::DegreesE7(-1_800_000_000)),
        (900_000_001, Value::DegreesE7(900_000_001)),
        (1_800_000_001, Value::Error),
    ] {
        assert_eq!(longitude.read(&raw.to_le_bytes()), Some(value), "{raw}");
    }
}

#[test]
fn codes_of_j1939_hold_in_messages_that_have_them() {
    let own = |bits| OwnSignal {
        has_j1939_codes: true,
        ..own(
            Signal::WheelSpeed,
            field(0, bits, Intel, Unsigned),
            1.0,
            0.0,
        )
    };
    for (bits, payload, value) in [
        (8, [0xfa, 0], Value::Real(250.0)),
        (8, [0xfb, 0], Value::Error),
        (8, [0xff, 0], Value::NotAvailable),
        (16, [0xff, 0xfa], Value::Real(64_255.0)),
        (16, [0x00, 0xfe], Value::Error),
        (16, [0x00, 0xff], Value::NotAvailable),
        (2, [1, 0], Value::Real(1.0)),
        (2, [2, 0], Value::Error),
        (2, [3, 0], Value::NotAvailable),
        (1, [1, 0], Value::Real(1.0)),
    ] {
        assert_eq!(own(bits).read(&payload), Some(value), "{bits} {payload:?}");
    }
}

#[test]
fn a_multiplexer_selects_signals() {
    let switch = Multiplexer {
        field: field(0, 8, Intel, Unsigned),
        ranges: &[(1, 1), (4, 6)],
    };
    let multiplexers = [switch];
    let altitude = OwnSignal {
        multiplexers: &multiplexers,
        ..own(Signal::Altitude, field(15, 16, Motorola, Signed), 0.5, 0.0)
    };
    for (switch, value) in [
        (0, None),
        (1, Some(Value::Real(128.5))),
        (3, None),
        (5, Some(Value::Real(128.5))),
        (7, None),
    ] {
        assert_eq!(altitude.read(&[switch, 1, 1]), value, "{switch}");
    }
    assert!(switch.selects(&[1]) && !switch.selects(&[]));
    // A number with a sign is no switch.
    let signed = Multiplexer {
        field: field(0, 8, Intel, Signed),
        ..switch
    };
    assert!(!signed.selects(&[1]));
}

const SPEED: u16 = 0x1a0;

fn standard(id: u16, data: &[u8]) -> TestFrame {
    TestFrame::new(StandardId::new(id).unwrap(), data).unwrap()
}

fn with_own_speed<T>(of: impl FnOnce(&[OwnMessage]) -> T) -> T {
    let signals = [own(
        Signal::WheelSpeed,
        field(7, 16, Motorola, Unsigned),
        0.01,
        0.0,
    )];
    of(&[OwnMessage {
        frames: FrameMatch::Standard(SPEED),
        signals: &signals,
    }])
}

#[test]
fn frames_are_matched_by_identifier_or_group() {
    let readings = |frame: &TestFrame| {
        with_own_speed(|messages| {
            let mut readings = Vec::new();
            let is_own = decode_own(messages, frame, |reading| readings.push(reading));
            (is_own, readings)
        })
    };
    let reading = Reading {
        signal: Signal::WheelSpeed,
        value: Value::Real(20.0),
    };
    let frame = standard(SPEED, &[0x07, 0xd0]);
    assert_eq!(readings(&frame), (true, vec![reading]));
    let shorter = standard(SPEED, &[0x07]);
    assert_eq!(readings(&shorter), (true, vec![]));
    let other = standard(SPEED + 1, &[0x07, 0xd0]);
    assert_eq!(readings(&other), (false, vec![]));
    let remote = TestFrame::new_remote(frame.id(), 2).unwrap();
    assert_eq!(readings(&remote), (false, vec![]));
    let wide = ExtendedId::new(SPEED.into()).unwrap();
    let wide = TestFrame::new(wide, &[0x07, 0xd0]).unwrap();
    assert_eq!(readings(&wide), (false, vec![]));

    let ccvs = Id::from(ExtendedId::new(0x18fe_f117).unwrap());
    assert!(FrameMatch::Group(65_265).accepts(ccvs));
    assert!(FrameMatch::Extended(0x18fe_f117).accepts(ccvs));
    assert!(!FrameMatch::Extended(0x18fe_f100).accepts(ccvs));
    assert!(!FrameMatch::Group(65_264).accepts(ccvs));
}

#[test]
fn a_reserved_signal_is_not_taken_from_built_in_messages() {
    let mut payload = [0; 8];
    encode(65_265, &mut payload, |signal| match signal {
        Signal::WheelSpeed => Value::Real(10.0),
        Signal::ParkingBrake | Signal::BrakeSwitch => Value::NotAvailable,
        _ => Value::Error,
    })
    .unwrap();
    let ccvs = TestFrame::of_pgn(65_265, 0, &payload);
    let retarder = TestFrame::of_pgn(
        61_440,
        16,
        &[0xff, 0x7d, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
    );
    let mut estimator = Estimator::<f32>::new(truck(), Tuning::default()).unwrap();
    let now = Instant::from_micros;
    assert_eq!(estimator.on_frame(now(0), &ccvs), Outcome::Used);
    assert_eq!(estimator.on_frame(now(1), &retarder), Outcome::Used);

    estimator.reserve(Signal::WheelSpeed);
    estimator.reserve(Signal::RetarderTorque);
    let before = estimator.counters().other_source;
    // Long after the time in which another source may take over.
    for second in 1..20 {
        let later = now(second * 1_000_000);
        assert_eq!(estimator.on_frame(later, &ccvs), Outcome::Ignored);
        assert_eq!(estimator.on_frame(later, &retarder), Outcome::Ignored);
        let reading = Reading {
            signal: Signal::WheelSpeed,
            value: Value::Real(20.0),
        };
        assert_eq!(estimator.on_reading(later, reading), Outcome::Used);
        while estimator.step().is_some() {}
    }
    assert_eq!(estimator.counters().other_source - before, 2 * 19);
    let live = estimator.live().unwrap();
    assert!((live.estimate.speed_mps - 20.0).abs() < 0.1, "{live:?}");
}

/// The table that the build script makes of `examples/own_dbc`.
mod generated {
    use estimator_core::Signal;
    use estimator_core::signal::own_message::{FrameMatch, Multiplexer, OwnMessage, OwnSignal};
    use estimator_core::signal::raw_field::{ByteOrder, NumberKind, RawField};

    include!(concat!(env!("OUT_DIR"), "/own_dbc_example.rs"));
}

#[test]
fn a_table_made_at_build_time_reads_the_cars_frames() {
    let readings = |id, data: &[u8]| {
        let mut readings = Vec::new();
        decode_own(&generated::CAR_MESSAGES, &standard(id, data), |reading| {
            readings.push((reading.signal, reading.value));
        });
        readings
    };
    let [a, b, c, d] = 473_769_123_i32.to_be_bytes();
    // -600 N; a latitude; 431.25 m with nine satellites; 72 km/h with the brake on.
    for (id, data, expected) in [
        (
            257,
            vec![0xfb, 0x50],
            vec![(Signal::TractionForce, Value::Real(-600.0))],
        ),
        (
            300,
            vec![2, a, b, c, d],
            vec![(Signal::Latitude, Value::DegreesE7(473_769_123))],
        ),
        (
            300,
            vec![1, 9, 0x00, 0x1d, 0x1a],
            vec![
                (Signal::Satellites, Value::Real(9.0)),
                (Signal::Altitude, Value::Real(431.25)),
            ],
        ),
        (
            513,
            vec![0x01, 0x1c, 0x20, 0],
            vec![
                (Signal::BrakeSwitch, Value::Real(1.0)),
                (Signal::WheelSpeed, Value::Real(20.0)),
            ],
        ),
        (
            513,
            vec![0x03, 0xff, 0xff, 0],
            vec![
                (Signal::BrakeSwitch, Value::NotAvailable),
                (Signal::WheelSpeed, Value::NotAvailable),
            ],
        ),
    ] {
        assert_eq!(readings(id, &data), expected, "{id} {data:?}");
    }
    let in_order = |message: &OwnMessage| message.signals.is_sorted_by_key(|own| own.signal);
    assert!(generated::CAR_MESSAGES.iter().all(in_order));
}
