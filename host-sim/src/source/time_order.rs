//! The order of frames in time.

use estimator_core::{Duration, Instant};

/// Largest disorder of frames. Frames of two interfaces, or of two senders on a virtual one, can
/// reach a logger in the wrong order. A frame within this limit gets the time of the one before.
const DISORDER: Duration = Duration::from_millis(10);

/// What is expected of the times of a log, for messages.
pub(super) const IN_ORDER: &str = "times that do not decrease by more than 10 ms";

/// The time of the newest frame of a log.
#[derive(Default)]
pub(super) struct TimeOrder {
    newest: Instant,
}

impl TimeOrder {
    /// Returns the time of the next frame, not before that of the newest one.
    ///
    /// # Errors
    /// Returns the problem, with both times, if the frame is older by more than 10 ms.
    pub(super) fn place(&mut self, logged: Instant) -> Result<Instant, String> {
        if self.newest.since(logged) > DISORDER {
            return Err(format!(
                "time runs backwards, from {} to {}",
                Seconds(self.newest),
                Seconds(logged)
            ));
        }
        self.newest = self.newest.max(logged);
        Ok(self.newest)
    }
}

/// A time as candump writes it.
pub(super) struct Seconds(pub(super) Instant);

impl std::fmt::Display for Seconds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let micros = self.0.micros();
        write!(f, "{}.{:06} s", micros / 1_000_000, micros % 1_000_000)
    }
}
