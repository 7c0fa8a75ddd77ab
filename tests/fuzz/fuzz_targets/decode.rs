//! Frames and fast packets: each decoded number is finite.

#![no_main]

use estimator_core::{Decoder, Value};
use fuzz_targets::{Event, EventBus};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|events: Vec<Event>| {
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
});
