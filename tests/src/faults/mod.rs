//! Faults of the bus, of senders and receivers, and of the clock. Each fault wraps a source of
//! frames.
//!
//! [`frames`] loses, repeats, delays and damages frames. [`signals`] changes their values,
//! [`clock`] changes their times of reception, and [`attack`] adds frames of another sender.
//! [`catalogue`] lists the faults by name, [`drive`] simulates the drives, [`outcome`] measures a
//! drive with a fault, and [`matrix`] runs every fault on every drive.

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

/// The time of a fault: from the start up to, but not including, the end.
pub type Window = Range<Instant>;

/// Returns seconds as a duration; zero if negative.
#[must_use]
pub fn seconds(seconds: f64) -> Duration {
    Duration::from_micros((seconds * 1e6).round() as u64)
}

/// Returns a random generator with a fixed seed.
#[must_use]
pub fn random() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(1)
}

/// Replaces each frame in the window by the frames that `change` returns: none, one or several.
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
