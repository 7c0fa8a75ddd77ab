//! Clocks that tell the time of reception wrong.

use super::{Frames, Window};
use estimator_core::{Duration, Instant};

/// Returns the clock is set back when the window opens, and stays so.
pub fn set_back<'a>(frames: Frames<'a>, window: Window, by: Duration) -> Frames<'a> {
    stamped(frames, move |time| {
        if time >= window.start {
            time - by
        } else {
            time
        }
    })
}

/// Returns the clock leaps ahead when the window opens, and stays so.
pub fn leaps<'a>(frames: Frames<'a>, window: Window, by: Duration) -> Frames<'a> {
    stamped(frames, move |time| {
        if time >= window.start {
            time + by
        } else {
            time
        }
    })
}

/// Returns one frame of `n` in the window is told to be later or, if not `ahead`, earlier.
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

/// Returns the clock counts microseconds in 32 bits, and begins anew when the window opens.
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
