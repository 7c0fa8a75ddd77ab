//! Messages that come faster than before.
//!
//! Two nodes that send the same message from one address look like one sender, but together they
//! send more often than one did. The usual rate is learned: senders differ, and few standards state
//! it.

use crate::signal::MESSAGE_COUNT;
use crate::time::Instant;

/// Messages in a group. Messages that wait for the bus, or in a gateway, come in bunches.
const GROUP: u32 = 8;
/// Time for which groups in a row are too fast until no bunch explains it, µs.
const LASTING_US: u32 = 1_000_000;
/// The same until it is the usual rate, µs: some senders are slow until the engine runs.
const USUAL_US: u32 = 120_000_000;

/// How the rate of a message is to its usual one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// It is the same, or it is lower or not known, or not eight messages have come.
    Usual,
    /// It is the same or lower again, after it was exceeded for long.
    UsualAgain,
    /// The last eight messages took less than three quarters of their usual time.
    Exceeded,
    /// So did those before, for a second and more.
    LongExceeded,
}

/// The rate of one message.
#[derive(Clone, Copy, Debug)]
struct MessageRate {
    /// Start of the group: the low 32 bits of its time, µs.
    since_us: u32,
    /// Usual duration of a group, µs; 0 until it is known.
    usual_us: u32,
    /// Before the usual duration is known, that of the last group; then, that of all groups in a row
    /// that were too fast. µs.
    unusual_us: u32,
    /// Messages since then. Without padding behind it, an image clears the table at once.
    count: u32,
}

/// Learned rates of all messages.
#[derive(Clone, Debug)]
pub struct RateMonitor {
    rates: [MessageRate; MESSAGE_COUNT],
}

impl RateMonitor {
    /// Creates the monitor before the first message.
    #[must_use]
    pub const fn new() -> Self {
        let rate = MessageRate {
            since_us: 0,
            usual_us: 0,
            unusual_us: 0,
            count: 0,
        };
        Self {
            rates: [rate; MESSAGE_COUNT],
        }
    }

    /// Takes the message with this index. Returns its rate where eight messages end.
    pub fn take(&mut self, message: usize, now: Instant) -> Rate {
        let Some(rate) = self.rates.get_mut(message) else {
            return Rate::Usual;
        };
        rate.count += 1;
        if rate.count < GROUP {
            return Rate::Usual;
        }
        rate.end_group(now.micros() as u32)
    }
}

impl Default for RateMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl MessageRate {
    #[inline(never)] // Not on the path of every frame.
    fn end_group(&mut self, now_us: u32) -> Rate {
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
            return Rate::Usual;
        }
        if took_us >= self.usual_us - self.usual_us / 4 {
            if is_near(self.usual_us) {
                // Clocks differ a little, and change with temperature.
                self.usual_us = self.usual_us - self.usual_us / 8 + eighth;
            }
            return self.usual_again();
        }
        self.unusual_us = self.unusual_us.saturating_add(took_us);
        match self.unusual_us {
            ..LASTING_US => Rate::Exceeded,
            LASTING_US..USUAL_US => Rate::LongExceeded,
            _ => {
                self.usual_us = took_us;
                self.usual_again()
            }
        }
    }

    fn usual_again(&mut self) -> Rate {
        match core::mem::take(&mut self.unusual_us) {
            ..LASTING_US => Rate::Usual,
            _ => Rate::UsualAgain,
        }
    }
}
