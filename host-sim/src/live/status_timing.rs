//! When the published status is due.

use estimator_core::{Cell, Disagreement, Live};
use std::time::{Duration, Instant as Monotonic};

/// Period of the status.
const PERIOD: Duration = Duration::from_secs(1);
/// Shortest time between two of them: J1939 allows ten frames a second on change.
const SPACING: Duration = Duration::from_millis(100);

/// The states of the switches in the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Switches {
    live: Option<Disagreement>,
    lagged_consistent: Option<bool>,
}

/// Decides when the status is sent: once a second, and when a switch has changed.
#[derive(Debug, Default)]
pub struct StatusTiming {
    last: Option<(Monotonic, Switches)>,
}

impl StatusTiming {
    /// Returns whether the status is due at `now`; it then counts as sent.
    pub fn is_due(&mut self, now: Monotonic, live: Option<&Live>, newest: Option<&Cell>) -> bool {
        let switches = Switches {
            live: live.map(|live| live.disagreement),
            lagged_consistent: newest.map(|cell| cell.lagged_consistent),
        };
        let is_due = self.last.is_none_or(|(at, sent)| {
            let wait = if sent == switches { PERIOD } else { SPACING };
            now.saturating_duration_since(at) >= wait
        });
        if is_due {
            self.last = Some((now, switches));
        }
        is_due
    }
}
