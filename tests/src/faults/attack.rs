//! Frames that somebody else sends: recorded ones of the same bus, which are as plausible as any.

use super::frames::{delayed, readdressed, repeated};
use super::{Frames, Window, seconds};
use estimator_core::{Duration, Instant};
use host_sim::source::can_frame::TimedFrame;

/// Address that no sender of the simulator has.
pub const STRANGER: u8 = 0x80;

/// Returns what was recorded `ago` before, sent again during the window from the address that
/// `address` makes of the true one, each frame `times` times as fast as it came.
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

/// Returns what comes much later in the recording, sent already now: for an attacker who was there
/// first.
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

/// Two sources heard on one bus.
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

/// Returns a stranger's frames come a little after the ones that they imitate, not at the same
/// moment.
#[must_use]
pub fn out_of_step(frames: Frames<'_>) -> Frames<'_> {
    let always = Instant::ZERO..Instant::from_micros(u64::MAX);
    delayed(frames, always, |_| seconds(0.003))
}
