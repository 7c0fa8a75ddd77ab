//! Frame rate over the last second.

use std::collections::VecDeque;
use std::time::{Duration, Instant as Monotonic};

/// Averaging time.
const WINDOW: Duration = Duration::from_secs(1);

/// The rate of a counter.
#[derive(Clone, Debug)]
pub(super) struct EventRate {
    counts: VecDeque<(Monotonic, u64)>,
}

impl EventRate {
    /// Creates a rate with a count of zero.
    pub(super) fn new(now: Monotonic) -> Self {
        Self {
            counts: VecDeque::from([(now, 0)]),
        }
    }

    /// Takes the current count and returns the rate over the last second, 1/s.
    pub(super) fn update(&mut self, now: Monotonic, count: u64) -> f64 {
        self.counts.push_back((now, count));
        let is_old = |at: &Monotonic| now.duration_since(*at) >= WINDOW;
        while self.counts.get(1).is_some_and(|(at, _)| is_old(at)) {
            self.counts.pop_front();
        }
        let Some((at, before)) = self.counts.front() else {
            return 0.0;
        };
        let seconds = now.duration_since(*at).as_secs_f64();
        if seconds > 0.0 {
            (count - before) as f64 / seconds
        } else {
            0.0
        }
    }
}
