//! Messages that come faster than they did.
//!
//! Two that send the same message from one address cannot be told apart, but together they send
//! more often than the one did. How often is learned: senders differ, and few standards say it.

use super::layout::MESSAGES;
use crate::time::Instant;

/// Messages in a stretch: what waits for the bus, or in a gateway, comes in bunches.
const STRETCH: u8 = 8;

/// Times of one message.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// When the stretch began, as the last bits of its microseconds.
    since_us: u32,
    /// How long a stretch takes; 0 as long as that is not known.
    usual_us: u32,
    /// How long the last one took that was none of the usual.
    unusual_us: u32,
    count: u8,
}

/// Learned times of all messages.
#[derive(Clone, Debug)]
pub struct RateCheck {
    rates: [Rate; MESSAGES.len()],
}

impl RateCheck {
    /// Nothing heard yet.
    #[must_use]
    pub const fn new() -> Self {
        let rate = Rate {
            since_us: 0,
            usual_us: 0,
            unusual_us: 0,
            count: 0,
        };
        Self {
            rates: [rate; MESSAGES.len()],
        }
    }

    /// Takes the message with this index; true if the last eight came in less than three quarters
    /// of the time that eight usually take.
    pub fn exceeds(&mut self, message: usize, now: Instant) -> bool {
        let Some(rate) = self.rates.get_mut(message) else {
            return false;
        };
        rate.count += 1;
        rate.count >= STRETCH && rate.ends(now.micros() as u32)
    }
}

impl Default for RateCheck {
    fn default() -> Self {
        Self::new()
    }
}

impl Rate {
    #[inline(never)] // Not where each frame passes.
    fn ends(&mut self, now_us: u32) -> bool {
        let took_us = now_us.wrapping_sub(self.since_us);
        self.since_us = now_us;
        self.count = 0;
        let eighth = took_us / 8;
        let near = |us: u32| us.abs_diff(took_us) <= eighth;
        if self.usual_us == 0 {
            // Two stretches that agree: there may be a gap in one.
            if near(self.unusual_us) {
                self.usual_us = took_us;
            }
            self.unusual_us = took_us;
            return false;
        }
        if near(self.usual_us) {
            // Clocks differ a little, and change with warmth.
            self.usual_us = self.usual_us - self.usual_us / 8 + eighth;
            return false;
        }
        took_us < self.usual_us - self.usual_us / 4
    }
}
