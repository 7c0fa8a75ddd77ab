//! Diagnostic answers (OBD-II): parameters of SAE J1979 in frames of ISO 15765-4.

use estimator_core::signal::encode;
use estimator_core::{Instant, Signal, Value};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::frame_readings::FrameReadings;

/// The engine's controller, with 11 and with 29 bits, and the gearbox's.
const ENGINE: u16 = 0x7e8;
const GEARBOX: u16 = 0x7e9;
const ENGINE_EXTENDED: u32 = 0x18da_f110;

fn standard(id: u16, data: &[u8]) -> CanFrame {
    CanFrame::standard(id, data).expect("an identifier")
}

/// Returns the readings of frames that come a tenth of a second apart.
fn readings(frames: &[CanFrame]) -> Vec<(Signal, f32)> {
    let mut reader = FrameReadings::default();
    let mut found = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let time = Instant::from_micros(k as u64 * 100_000);
        let timed = TimedFrame {
            time,
            frame: *frame,
        };
        reader.decode(&timed, |reading| match reading.value {
            Value::Real(value) => found.push((reading.signal, value)),
            other => panic!("{other:?}"),
        });
    }
    found
}

#[test]
fn each_parameter_is_read_as_the_standard_has_it() {
    for (data, signal, expected) in [
        (
            &[4, 0x41, 0x0c, 0x1a, 0xf8][..],
            Signal::EngineSpeed,
            1726.0,
        ),
        (&[3, 0x41, 0x0d, 90], Signal::WheelSpeed, 25.0),
        (&[3, 0x41, 0x33, 99], Signal::AirPressure, 99_000.0),
        (&[3, 0x41, 0x46, 60], Signal::AmbientTemperature, 20.0),
        (&[3, 0x41, 0x62, 165], Signal::EngineTorque, 40.0),
        (&[3, 0x41, 0x62, 115], Signal::EngineTorque, -10.0),
        (
            &[4, 0x41, 0x63, 0x01, 0x5e],
            Signal::EngineReferenceTorque,
            350.0,
        ),
        (&[3, 0x41, 0x8e, 135], Signal::FrictionTorque, 10.0),
        (
            &[6, 0x41, 0xa4, 3, 0x40, 0x03, 0xf2],
            Signal::GearRatio,
            1.01,
        ),
        // Service 22, as newer vehicles have it.
        (&[4, 0x62, 0xf4, 0x0d, 36], Signal::WheelSpeed, 10.0),
    ] {
        let mut padded = data.to_vec();
        padded.resize(8, 0xaa);
        let frames = [
            standard(ENGINE, &padded),
            standard(ENGINE, data),
            CanFrame::extended(ENGINE_EXTENDED, &padded).expect("an identifier"),
        ];
        for frame in frames {
            assert_eq!(readings(&[frame]), [(signal, expected)], "{data:02x?}");
        }
    }
}

#[test]
fn an_answer_with_several_parameters_comes_in_several_frames() {
    // 0C, 0D, 62, 63: 1 + 3 + 2 + 2 + 3 bytes.
    let frames = [
        standard(ENGINE, &[0x10, 11, 0x41, 0x0c, 0x1a, 0xf8, 0x0d, 36]),
        standard(0x7e0, &[0x30, 0, 0, 0, 0, 0, 0, 0]),
        // Another controller answers between them.
        standard(GEARBOX, &[6, 0x41, 0xa4, 3, 0x40, 0x03, 0xf2, 0]),
        standard(ENGINE, &[0x21, 0x62, 165, 0x63, 1, 0x5e, 0x55, 0x55]),
    ];
    let all = [
        (Signal::GearRatio, 1.01),
        (Signal::EngineReferenceTorque, 350.0),
        (Signal::EngineSpeed, 1726.0),
        (Signal::EngineTorque, 40.0),
        (Signal::WheelSpeed, 10.0),
    ];
    assert_eq!(readings(&frames), all);
    // One frame is lost: the answer counts for nothing.
    assert_eq!(readings(&[frames[0], frames[2]]), all[..1]);
    let other = standard(ENGINE, &[0x22, 0x62, 165, 0x63, 1, 0x5e, 0x55, 0x55]);
    assert_eq!(readings(&[frames[0], other, frames[3]]), []);
}

#[test]
fn what_cannot_be_taken_apart_without_doubt_is_no_reading() {
    for data in [
        // Fewer bytes than the parameter has, and more.
        &[3, 0x41, 0x0c, 0x1a][..],
        &[4, 0x41, 0x0d, 90, 0],
        // A parameter of unknown length before the speed.
        &[5, 0x41, 0xf0, 1, 0x0d, 90],
        // Other services: the car's number, a refusal, trouble codes, an identifier of a maker.
        &[3, 0x49, 0x0d, 90],
        &[3, 0x7f, 0x01, 0x12],
        &[3, 0x43, 0x0d, 90],
        &[4, 0x62, 0x12, 0x0d, 90],
        // A length beyond the frame, and none.
        &[9, 0x41, 0x0d, 90],
        &[7, 0x41, 0x0d, 90],
        &[0, 0x41, 0x0d, 90],
        // No ratio is supported.
        &[6, 0x41, 0xa4, 1, 0x40, 0x03, 0xf2],
        &[],
    ] {
        assert_eq!(readings(&[standard(ENGINE, data)]), [], "{data:02x?}");
    }
    // The request, and an identifier of no diagnosis.
    let speed = [3, 0x41, 0x0d, 90];
    assert_eq!(
        readings(&[standard(0x7e0, &speed), standard(0x7f0, &speed)]),
        []
    );
    let to_another = CanFrame::extended(0x18da_10f1, &speed).expect("an identifier");
    assert_eq!(readings(&[to_another]), []);
}

#[test]
fn one_controller_gives_a_signal_until_it_is_silent() {
    let speed = |id, kmh| standard(id, &[3, 0x41, 0x0d, kmh]);
    let frames = [speed(ENGINE, 36), speed(GEARBOX, 72), speed(ENGINE, 36)];
    let both = [(Signal::WheelSpeed, 10.0); 2];
    assert_eq!(readings(&frames), both);
    // 40 s later the other one counts.
    let filler = standard(0x123, &[]);
    let mut late = vec![filler; 400];
    late.splice(..2, frames[..2].iter().copied());
    late.push(speed(GEARBOX, 72));
    assert_eq!(readings(&late).last(), Some(&(Signal::WheelSpeed, 20.0)));
}

#[test]
fn what_the_bus_broadcasts_comes_before_answers() {
    let mut payload = [0xff; 8];
    let value = |signal| match signal {
        Signal::WheelSpeed => Value::Real(10.0),
        _ => Value::NotAvailable,
    };
    encode(65_265, &mut payload, value).expect("CCVS1");
    let broadcast = CanFrame::extended(0x18fe_f100, &payload).expect("an identifier");
    let silent = CanFrame::extended(0x18fe_f100, &[0xff; 8]).expect("an identifier");
    let speed = standard(ENGINE, &[3, 0x41, 0x0d, 36]);
    let torque = standard(ENGINE, &[3, 0x41, 0x62, 165]);
    let both = [(Signal::WheelSpeed, 10.0), (Signal::EngineTorque, 40.0)];
    assert_eq!(readings(&[speed, silent, torque]), both);
    assert_eq!(readings(&[torque, broadcast, speed, torque]), [both[1]; 2]);
}
