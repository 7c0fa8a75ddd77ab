//! Signals with wrong values. All other signals in their messages are right.

use super::{Frames, Window};
use embedded_can::{Frame, Id};
use estimator_core::signal::{FrameOutcome, encode, messages};
use estimator_core::{Decoder, Instant, Reading, Signal, Value};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use std::collections::{BTreeMap, VecDeque};

/// Longest payload that is encoded, bytes.
const PAYLOAD: usize = 64;

/// Rewrites whole messages. `change` gets the time in the window, s, and a signal with its value,
/// and returns the value to send.
pub fn rewritten<'a>(
    frames: Frames<'a>,
    window: Window,
    change: impl FnMut(f64, Signal, Value) -> Value + 'a,
) -> Frames<'a> {
    Box::new(Rewritten {
        frames,
        window,
        change,
        decoder: Decoder::new(),
        open: Vec::new(),
        ready: VecDeque::new(),
    })
}

/// Sends `value` instead of some signals.
pub fn replaced<'a>(
    frames: Frames<'a>,
    window: Window,
    signals: &'a [Signal],
    value: Value,
) -> Frames<'a> {
    rewritten(frames, window, move |_, signal, true_value| {
        if signals.contains(&signal) {
            value
        } else {
            true_value
        }
    })
}

/// Holds some signals at the first value in the window.
pub fn stuck<'a>(frames: Frames<'a>, window: Window, signals: &'a [Signal]) -> Frames<'a> {
    let mut held = BTreeMap::new();
    rewritten(frames, window, move |_, signal, value| {
        if signals.contains(&signal) {
            *held.entry(signal).or_insert(value)
        } else {
            value
        }
    })
}

/// Replaces the numbers of some signals by what `of` returns for the time in the window, s, and the
/// number.
pub fn altered<'a>(
    frames: Frames<'a>,
    window: Window,
    signals: &'a [Signal],
    mut of: impl FnMut(f64, f32) -> f32 + 'a,
) -> Frames<'a> {
    rewritten(frames, window, move |seconds, signal, value| match value {
        Value::Real(number) if signals.contains(&signal) => Value::Real(of(seconds, number)),
        other => other,
    })
}

struct Rewritten<'a, C> {
    frames: Frames<'a>,
    window: Window,
    change: C,
    decoder: Decoder,
    /// Frames of the fast packet that is not yet complete.
    open: Vec<TimedFrame>,
    ready: VecDeque<TimedFrame>,
}

impl<C: FnMut(f64, Signal, Value) -> Value> Rewritten<'_, C> {
    fn take(&mut self, timed: TimedFrame) {
        let (mut message, mut readings) = (0, Vec::new());
        let outcome = self.decoder.decode(&timed.frame, |index, _, reading| {
            message = index;
            readings.push(reading);
        });
        self.open.push(timed);
        match outcome {
            FrameOutcome::Partial => return,
            FrameOutcome::Decoded { .. } => self.rewrite(message, &readings),
            FrameOutcome::Ignored | FrameOutcome::Rejected(_) => {}
        }
        self.ready.extend(self.open.drain(..));
    }

    /// Encodes the message that is in the last frame, or ends there, with the changed values.
    fn rewrite(&mut self, message: usize, readings: &[Reading]) {
        let Some((last, pgn)) = self
            .open
            .last()
            .copied()
            .zip(messages().nth(message).map(|message| message.pgn()))
        else {
            return;
        };
        let seconds = in_window(&self.window, last.time);
        let value_of = |signal| {
            let mut of_signal = readings.iter().filter(|reading| reading.signal == signal);
            let value = of_signal.next().map_or(Value::NotAvailable, |r| r.value);
            (self.change)(seconds, signal, value)
        };
        let mut payload = [0xff; PAYLOAD];
        let Some(length) = encode(pgn, &mut payload, value_of) else {
            return;
        };
        let mut rest = &payload[..length];
        let parts = self
            .open
            .iter_mut()
            .filter(|t| t.frame.id() == last.frame.id());
        for (index, part) in parts.enumerate() {
            // A fast packet begins with two bytes of its own, and each later frame with one.
            let head = match (length > 8, index) {
                (false, _) => 0,
                (true, 0) => 2,
                (true, _) => 1,
            };
            let mut data = part.frame.data().to_vec();
            let count = rest.len().min(data.len().saturating_sub(head));
            data[head..head + count].copy_from_slice(&rest[..count]);
            rest = &rest[count..];
            part.frame = same_id(part.frame.id(), &data);
        }
    }
}

fn same_id(id: Id, data: &[u8]) -> CanFrame {
    CanFrame::new(id, data).expect("as many bytes as before")
}

fn in_window(window: &Window, time: Instant) -> f64 {
    time.since(window.start).micros() as f64 * 1e-6
}

impl<C: FnMut(f64, Signal, Value) -> Value> Iterator for Rewritten<'_, C> {
    type Item = TimedFrame;

    fn next(&mut self) -> Option<TimedFrame> {
        while self.ready.is_empty() {
            let Some(timed) = self.frames.next() else {
                // The recording ends within a fast packet.
                self.ready.extend(self.open.drain(..));
                break;
            };
            if self.window.contains(&timed.time) {
                self.take(timed);
            } else {
                self.ready.extend(self.open.drain(..));
                self.ready.push_back(timed);
            }
        }
        self.ready.pop_front()
    }
}
