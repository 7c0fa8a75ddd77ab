//! Frames of an attacker: recorded frames of the same bus, which are as plausible as any.

use super::frames::{delayed, readdressed, repeated};
use super::{Frames, Window, seconds};
use estimator_core::{Duration, Instant};
use host_sim::source::can_frame::TimedFrame;

/// Source address that no sender of the simulator has.
pub const STRANGER: u8 = 0x80;

/// Sends the frames that were recorded `ago` before the window again during the window, each
/// `times` times. `address` returns the source address for the true one.
pub fn replayed<'a>(
    recording: &'a [TimedFrame],
    window: Window,
    ago: Duration,
    times: usize,
    address: impl FnMut(u8) -> u8 + 'a,
) -> Frames<'a> {
    let from = window.start - ago;
    let until = window.end - ago;
    let always = Instant::ZERO..Instant::from_micros(u64::MAX);
    let again = recording
        .iter()
        .filter(move |timed| (from..until).contains(&timed.time))
        .map(move |timed| TimedFrame {
            time: timed.time + ago,
            ..*timed
        });
    let readdressed = readdressed(Box::new(again), always.clone(), address);
    repeated(readdressed, always, times)
}

/// Sends the frames that come `by` later in the recording during the window: an attacker that
/// sends before the true sender.
pub fn foretold(recording: &[TimedFrame], window: Window, by: Duration, address: u8) -> Frames<'_> {
    let always = Instant::ZERO..Instant::from_micros(u64::MAX);
    let early = recording
        .iter()
        .filter(move |timed| (window.start + by..window.end + by).contains(&timed.time))
        .map(move |timed| TimedFrame {
            time: timed.time - by,
            ..*timed
        });
    readdressed(Box::new(early), always, move |_| address)
}

/// Merges two sources of frames in the order of time.
pub fn both<'a>(one: Frames<'a>, other: Frames<'a>) -> Frames<'a> {
    let (mut one, mut other) = (one.peekable(), other.peekable());
    Box::new(std::iter::from_fn(move || {
        match (one.peek(), other.peek()) {
            (Some(a), Some(b)) if b.time < a.time => other.next(),
            (Some(_), _) => one.next(),
            (None, _) => other.next(),
        }
    }))
}

/// Delays an attacker's frames a little, so that they do not coincide with the ones they imitate.
#[must_use]
pub fn out_of_step(frames: Frames<'_>) -> Frames<'_> {
    let always = Instant::ZERO..Instant::from_micros(u64::MAX);
    delayed(frames, always, |_| seconds(0.003))
}
