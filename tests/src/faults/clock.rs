//! Clocks that report a wrong time of reception.

use super::{Frames, Window};
use estimator_core::{Duration, Instant};

/// Sets the clock back for good when the window opens.
pub fn set_back<'a>(frames: Frames<'a>, window: Window, by: Duration) -> Frames<'a> {
    stamped(frames, move |time| {
        if time >= window.start {
            time - by
        } else {
            time
        }
    })
}

/// Sets the clock ahead for good when the window opens.
pub fn leaps<'a>(frames: Frames<'a>, window: Window, by: Duration) -> Frames<'a> {
    stamped(frames, move |time| {
        if time >= window.start {
            time + by
        } else {
            time
        }
    })
}

/// Stamps one frame of `n` in the window too late or, if not `ahead`, too early.
pub fn strays<'a>(
    frames: Frames<'a>,
    window: Window,
    n: u32,
    by: Duration,
    ahead: bool,
) -> Frames<'a> {
    let mut count = 0;
    stamped(frames, move |time| {
        if !window.contains(&time) {
            return time;
        }
        count = (count + 1) % n;
        match (count, ahead) {
            (0, true) => time + by,
            (0, false) => time - by,
            _ => time,
        }
    })
}

/// Counts microseconds in 32 bits. The count wraps when the window opens.
pub fn wraps(frames: Frames<'_>, window: Window) -> Frames<'_> {
    let start = window.start.micros();
    stamped(frames, move |time| {
        Instant::from_micros(time.micros().wrapping_sub(start) % (1 << 32))
    })
}

fn stamped<'a>(frames: Frames<'a>, mut stamp: impl FnMut(Instant) -> Instant + 'a) -> Frames<'a> {
    Box::new(frames.map(move |mut timed| {
        timed.time = stamp(timed.time);
        timed
    }))
}
