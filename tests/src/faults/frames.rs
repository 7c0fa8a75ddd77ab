//! Frames that are lost, repeated, late, out of order or damaged.

use super::{Frames, Window, changed, random};
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::{Duration, Instant};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Loses the frames for which `lost` returns true.
pub fn lost<'a>(
    frames: Frames<'a>,
    window: Window,
    mut lost: impl FnMut(&TimedFrame) -> bool + 'a,
) -> Frames<'a> {
    changed(frames, window, move |timed| {
        (!lost(&timed)).then_some(timed)
    })
}

/// Loses one frame of `n`.
pub fn every_lost<'a>(frames: Frames<'a>, window: Window, n: u32) -> Frames<'a> {
    let mut count = 0;
    lost(frames, window, move |_| {
        count = (count + 1) % n;
        count == 0
    })
}

/// Loses each frame with a probability.
pub fn randomly_lost<'a>(frames: Frames<'a>, window: Window, probability: f64) -> Frames<'a> {
    let mut rng = random();
    lost(frames, window, move |_| rng.random_bool(probability))
}

/// Repeats each frame, so that it comes `times` times in a row.
pub fn repeated<'a>(frames: Frames<'a>, window: Window, times: usize) -> Frames<'a> {
    changed(frames, window, move |timed| {
        std::iter::repeat_n(timed, times)
    })
}

/// Delays each frame by the duration that `delay` returns.
pub fn delayed<'a>(
    frames: Frames<'a>,
    window: Window,
    delay: impl FnMut(&mut ChaCha8Rng) -> Duration + 'a,
) -> Frames<'a> {
    Box::new(Delayed {
        frames,
        window,
        delay,
        rng: random(),
        next: None,
        under_way: BTreeMap::new(),
        sent: 0,
    })
}

struct Delayed<'a, D> {
    frames: Frames<'a>,
    window: Window,
    delay: D,
    rng: ChaCha8Rng,
    next: Option<TimedFrame>,
    /// By time of arrival, then by the order of sending.
    under_way: BTreeMap<(Instant, u64), TimedFrame>,
    sent: u64,
}

impl<D: FnMut(&mut ChaCha8Rng) -> Duration> Iterator for Delayed<'_, D> {
    type Item = TimedFrame;

    fn next(&mut self) -> Option<TimedFrame> {
        loop {
            self.next = self.next.take().or_else(|| self.frames.next());
            let arrives = self.under_way.first_key_value().map(|(key, _)| key.0);
            match (&self.next, arrives) {
                (Some(next), Some(arrives)) if arrives < next.time => break,
                (Some(_), _) => {}
                (None, _) => break,
            }
            let mut timed = self.next.take()?;
            if !self.window.contains(&timed.time) && self.under_way.is_empty() {
                return Some(timed);
            }
            if self.window.contains(&timed.time) {
                timed.time = timed.time + (self.delay)(&mut self.rng);
            }
            self.under_way.insert((timed.time, self.sent), timed);
            self.sent += 1;
        }
        self.under_way.pop_first().map(|(_, timed)| timed)
    }
}

/// Swaps each frame with the next one, together with their times of reception or without.
pub fn swapped<'a>(frames: Frames<'a>, window: Window, with_times: bool) -> Frames<'a> {
    let mut waiting: Option<TimedFrame> = None;
    // A frame that still waits when the window closes is swapped with the next one.
    let end = window.end;
    changed(
        frames,
        window.start..Instant::from_micros(u64::MAX),
        move |timed| {
            let (mut first, second) = match waiting.take() {
                Some(before) => (timed, Some(before)),
                None if timed.time < end => {
                    waiting = Some(timed);
                    return Vec::new();
                }
                None => (timed, None),
            };
            let mut second = second;
            if let (Some(second), false) = (&mut second, with_times) {
                std::mem::swap(&mut first.time, &mut second.time);
            }
            std::iter::once(first).chain(second).collect()
        },
    )
}

/// Truncates one frame of `n` to a random length.
pub fn truncated<'a>(frames: Frames<'a>, window: Window, n: u32) -> Frames<'a> {
    let mut rng = random();
    changed(frames, window, move |timed| {
        let data = timed.frame.data();
        let cut = rng.random_ratio(1, n) && !data.is_empty();
        let length = if cut {
            rng.random_range(0..data.len())
        } else {
            data.len()
        };
        CanFrame::new(timed.frame.id(), &data[..length]).map(|frame| TimedFrame { frame, ..timed })
    })
}

/// Declares the largest possible length in each fast packet.
pub fn overlong_packets<'a>(frames: Frames<'a>, window: Window) -> Frames<'a> {
    changed(frames, window, |mut timed| {
        if is_fast_packet(&timed.frame) && timed.frame.data()[0] & 0x1f == 0 {
            set_byte(&mut timed.frame, 1, 223);
        }
        Some(timed)
    })
}

/// Replaces the sequence counter of each fast packet by what `sequence` returns for it.
pub fn sequenced<'a>(
    frames: Frames<'a>,
    window: Window,
    mut sequence: impl FnMut(u8) -> u8 + 'a,
) -> Frames<'a> {
    changed(frames, window, move |mut timed| {
        if is_fast_packet(&timed.frame) {
            let head = timed.frame.data()[0];
            set_byte(&mut timed.frame, 0, sequence(head >> 5) << 5 | head & 0x1f);
        }
        Some(timed)
    })
}

/// Flips one bit of one frame of `n`.
pub fn bit_flipped<'a>(frames: Frames<'a>, window: Window, n: u32) -> Frames<'a> {
    let mut rng = random();
    changed(frames, window, move |mut timed| {
        let bits = 8 * timed.frame.data().len();
        if rng.random_ratio(1, n) && bits > 0 {
            let bit = rng.random_range(0..bits);
            let byte = timed.frame.data()[bit / 8] ^ (1 << (bit % 8));
            set_byte(&mut timed.frame, bit / 8, byte);
        }
        Some(timed)
    })
}

/// Replaces the source address of each frame by what `address` returns for it.
pub fn readdressed<'a>(
    frames: Frames<'a>,
    window: Window,
    mut address: impl FnMut(u8) -> u8 + 'a,
) -> Frames<'a> {
    changed(frames, window, move |timed| {
        let id = raw_id(&timed.frame)?;
        let id = ExtendedId::new(id & !0xff | u32::from(address(id as u8)))?;
        let frame = CanFrame::new(id, timed.frame.data())?;
        Some(TimedFrame { frame, ..timed })
    })
}

/// Adds after each frame another one, whose 11-bit identifier is the last bits of the first.
pub fn with_short_twins<'a>(frames: Frames<'a>, window: Window) -> Frames<'a> {
    changed(frames, window, |timed| {
        let id = raw_id(&timed.frame).and_then(|id| StandardId::new(id as u16 & 0x7ff));
        let twin = id.and_then(|id| CanFrame::new(id, &[0x55; 8]));
        let twin = twin.map(|frame| TimedFrame { frame, ..timed });
        std::iter::once(timed).chain(twin)
    })
}

/// Returns the parameter group of a frame with a 29-bit identifier.
#[must_use]
pub fn pgn(frame: &CanFrame) -> Option<u32> {
    raw_id(frame).map(|id| estimator_core::signal::Pgn::from_raw(id).number)
}

fn raw_id(frame: &CanFrame) -> Option<u32> {
    match frame.id() {
        Id::Extended(id) => Some(id.as_raw()),
        Id::Standard(_) => None,
    }
}

/// Returns whether a frame of the simulator is part of a fast packet.
fn is_fast_packet(frame: &CanFrame) -> bool {
    matches!(pgn(frame), Some(129_029))
}

fn set_byte(frame: &mut CanFrame, index: usize, byte: u8) {
    let mut data = frame.data().to_vec();
    data[index] = byte;
    if let Some(changed) = CanFrame::new(frame.id(), &data) {
        *frame = changed;
    }
}
