//! Faults of a bus, of what is on it and of who listens: each one wraps a source of frames.
//!
//! [`frames`] loses, repeats, delays and damages frames, [`signals`] changes what they say,
//! [`clock`] when they were received, and [`attack`] adds those of somebody else. [`catalogue`] has
//! the faults by name, [`drive`] the drives that they happen to, [`outcome`] what came of it, and
//! [`matrix`] the table of all.

pub mod attack;
pub mod catalogue;
pub mod clock;
pub mod drive;
pub mod frames;
pub mod matrix;
pub mod outcome;
pub mod shortfalls;
pub mod signals;
pub mod table;

use estimator_core::{Duration, Instant};
use host_sim::source::can_frame::TimedFrame;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Frames in the order in which they were received.
pub type Frames<'a> = Box<dyn Iterator<Item = TimedFrame> + 'a>;

/// When something is wrong: from a time on, until before another.
pub type Window = Range<Instant>;

/// Seconds as a span of time; none if negative.
#[must_use]
pub fn seconds(seconds: f64) -> Duration {
    Duration::from_micros((seconds * 1e6).round() as u64)
}

/// Returns the same numbers each time.
#[must_use]
pub fn random() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(1)
}

/// Makes `change` of each frame within the window: none, one or several.
pub fn changed<'a, I: IntoIterator<Item = TimedFrame> + 'a>(
    frames: Frames<'a>,
    window: Window,
    mut change: impl FnMut(TimedFrame) -> I + 'a,
) -> Frames<'a> {
    Box::new(frames.flat_map(move |timed| {
        let within = window.contains(&timed.time);
        let (as_it_was, changed) = if within {
            (None, Some(change(timed)))
        } else {
            (Some(timed), None)
        };
        as_it_was.into_iter().chain(changed.into_iter().flatten())
    }))
}
