//! Frames and fast packets: each decoded number is finite.

use super::from_bytes;
use crate::bus::{Event, EventBus};
use estimator_core::{Decoder, Value};

/// Checks the events that the bytes make.
pub fn decode(bytes: &[u8]) {
    let Some(events) = from_bytes::<Vec<Event>>(bytes) else {
        return;
    };
    let (mut bus, mut decoder) = (EventBus::default(), Decoder::new());
    for event in &events {
        bus.play(event, &mut |timed| {
            decoder.decode(&timed.frame, |_, _, reading| {
                if let Value::Real(value) = reading.value {
                    assert!(value.is_finite(), "{reading:?}");
                }
            });
        });
    }
}
