//! Traffic as the bytes of which `arbitrary` makes it.

use crate::traffic::Events;
use arbitrary::{Arbitrary, Unstructured};
use fuzz_targets::bus::Event;

const KINDS: u64 = 6;

/// Returns the bytes of which `arbitrary` makes these events.
///
/// # Panics
/// Panics if `arbitrary` makes other events of them.
pub fn encoded(events: &[Event]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for event in events {
        // Another event follows.
        bytes.push(1);
        encode(event, &mut bytes);
    }
    let decoded = Events::arbitrary_take_rest(Unstructured::new(&bytes)).expect("events");
    assert_eq!(format!("{decoded:?}"), format!("{events:?}"));
    bytes
}

fn encode(event: &Event, bytes: &mut Vec<u8>) {
    let mut kind = |kind: u64| {
        // The least number that `arbitrary` maps to this kind.
        let number = (kind << 32).div_ceil(KINDS) as u32;
        bytes.extend(number.to_le_bytes());
    };
    match *event {
        Event::Frame {
            id,
            extended,
            remote,
            length,
            data,
        } => {
            kind(0);
            bytes.extend(id.to_le_bytes());
            bytes.extend([u8::from(extended), u8::from(remote), length]);
            bytes.extend(data);
        }
        Event::Message {
            which,
            source,
            sequence,
            data,
        } => {
            kind(1);
            bytes.extend([which, source, sequence]);
            bytes.extend(data);
        }
        Event::Part {
            which,
            source,
            head,
            length,
            data,
        } => {
            kind(2);
            bytes.extend([which, source, head, length]);
            bytes.extend(data);
        }
        Event::Drive {
            seconds,
            speed_cmps,
            torque_percent,
            gear,
            climb_cmps,
            braking,
            shifting,
            gnss,
        } => {
            kind(3);
            bytes.push(seconds);
            bytes.extend(speed_cmps.to_le_bytes());
            bytes.extend(torque_percent.to_le_bytes());
            bytes.extend(gear.to_le_bytes());
            bytes.extend(climb_cmps.to_le_bytes());
            bytes.extend([braking, shifting, gnss].map(u8::from));
        }
        Event::Signal {
            which,
            value,
            source,
        } => {
            kind(4);
            bytes.push(which);
            bytes.extend(value.to_bits().to_le_bytes());
            bytes.push(source);
        }
        Event::Wait { millis } => {
            kind(5);
            bytes.extend(millis.to_le_bytes());
        }
    }
}
