//! Messages that come faster than before.
//!
//! Two nodes that send the same message from one address look like one sender, but together they
//! send more often than one did. The usual rate is learned: senders differ, and few standards state
//! it.

use crate::signal::MESSAGE_COUNT;
use crate::time::Instant;

/// Messages in a group. Messages that wait for the bus, or in a gateway, come in bunches.
const GROUP: u32 = 8;

/// The rate of one message.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// Start of the group: the low 32 bits of its time, µs.
    since_us: u32,
    /// Usual duration of a group, µs; 0 until it is known.
    usual_us: u32,
    /// Duration of the last group that differed, µs.
    unusual_us: u32,
    /// Messages since then. Without padding behind it, an image clears the table at once.
    count: u32,
}

/// Learned rates of all messages.
#[derive(Clone, Debug)]
pub struct RateMonitor {
    rates: [Rate; MESSAGE_COUNT],
}

impl RateMonitor {
    /// Creates the monitor before the first message.
    #[must_use]
    pub const fn new() -> Self {
        let rate = Rate {
            since_us: 0,
            usual_us: 0,
            unusual_us: 0,
            count: 0,
        };
        Self {
            rates: [rate; MESSAGE_COUNT],
        }
    }

    /// Takes the message with this index. Returns true if the last eight took less than three
    /// quarters of their usual time.
    pub fn exceeds(&mut self, message: usize, now: Instant) -> bool {
        let Some(rate) = self.rates.get_mut(message) else {
            return false;
        };
        rate.count += 1;
        rate.count >= GROUP && rate.end_group(now.micros() as u32)
    }
}

impl Default for RateMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl Rate {
    #[inline(never)] // Not on the path of every frame.
    fn end_group(&mut self, now_us: u32) -> bool {
        let took_us = now_us.wrapping_sub(self.since_us);
        self.since_us = now_us;
        self.count = 0;
        let eighth = took_us / 8;
        let is_near = |us: u32| us.abs_diff(took_us) <= eighth;
        if self.usual_us == 0 {
            // Two groups that agree: there may be a gap in one.
            if is_near(self.unusual_us) {
                self.usual_us = took_us;
            }
            self.unusual_us = took_us;
            return false;
        }
        if is_near(self.usual_us) {
            // Clocks differ a little, and change with temperature.
            self.usual_us = self.usual_us - self.usual_us / 8 + eighth;
            return false;
        }
        took_us < self.usual_us - self.usual_us / 4
    }
}
