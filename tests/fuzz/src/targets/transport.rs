//! Sessions of the transport protocol: a value is one that its sender announced and sent.

use super::from_bytes;
use crate::sessions::{Packet, Reference};
use embedded_can::Frame;
use estimator_core::{Decoder, Instant, Signal, Value};

/// Returns the place of a signal in its payload, and its scale.
fn place(signal: Signal) -> (usize, f32) {
    match signal {
        Signal::EngineReferenceTorque => (19, 1.0),
        Signal::EngineInertia => (30, 0.004),
        Signal::RetarderReferenceTorque => (16, 1.0),
        other => panic!("{other:?} is in no multi-packet message"),
    }
}

/// Checks the packets that the bytes make.
pub fn transport(bytes: &[u8]) {
    let Some(packets) = from_bytes::<Vec<Packet>>(bytes) else {
        return;
    };
    let (mut decoder, mut reference) = (Decoder::new(), Reference::default());
    let mut millis = 0;
    for packet in &packets {
        millis += u64::from(packet.wait_ms % 2_000);
        let Some(frame) = packet.frame() else {
            continue;
        };
        reference.take(packet, frame.data());
        let now = Instant::from_micros(1_000 * millis);
        decoder.decode_at(now, &frame, |_, pgn, reading| {
            let payload = reference.payload(packet, pgn.number);
            let payload = payload.expect("all packets were sent");
            let (first, scale) = place(reading.signal);
            let raw = u16::from_le_bytes([payload[first], payload[first + 1]]);
            match reading.value {
                Value::Real(value) => assert_eq!(value, f32::from(raw) * scale),
                Value::Error => assert!((0xfb00..0xff00).contains(&raw)),
                Value::NotAvailable => assert!(raw >= 0xff00),
                Value::DegreesE7(_) => panic!("no angle"),
            }
        });
    }
}
