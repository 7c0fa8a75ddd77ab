//! One source for each signal: who came first keeps the word until it falls silent.
//!
//! Two controllers may send the same parameter group (a brake and an engine controller both send
//! CCVS1), and two groups the same signal (a position comes in 129025 and in 129029). Mixing
//! them would add their offsets as noise. A truck may have two retarders, though, one at the engine
//! and one at the gearbox, and each tells of its own: they all have the word.

use super::Signal;
use crate::time::{Duration, Instant};

/// Silence after which another source may take over.
const TIMEOUT: Duration = Duration::from_millis(5000);

/// Whether a reading comes from the source that has the word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// From the source in use.
    Admitted,
    /// From a source that took over from a silent one: an offset may have come with it.
    Switched,
    /// Another source has the word.
    Refused,
}

#[derive(Clone, Copy, Debug)]
struct Holder {
    source: u16,
    heard: Instant,
}

/// A source that no message has: there are not so many.
const NOBODY: u16 = u16::MAX;

/// The source heard for each signal.
#[derive(Clone, Debug)]
pub struct SourceLock {
    holders: [Holder; Signal::ALL.len()],
}

impl SourceLock {
    /// Nobody heard yet.
    #[must_use]
    pub const fn new() -> Self {
        let nobody = Holder {
            source: NOBODY,
            heard: Instant::ZERO,
        };
        Self {
            holders: [nobody; Signal::ALL.len()],
        }
    }

    /// Whether the reading of `signal` in the message with index `message` sent from `address`
    /// counts. Only a measurement (`available`) takes or keeps the word.
    pub fn admit(
        &mut self,
        signal: Signal,
        message: usize,
        address: u8,
        now: Instant,
        available: bool,
    ) -> Admission {
        if signal == Signal::RetarderTorque {
            return Admission::Admitted;
        }
        let source = ((message as u16) << 8) | u16::from(address);
        let Some(holder) = self.holders.get_mut(signal as usize) else {
            return Admission::Refused;
        };
        let admission = if holder.source == source || holder.source == NOBODY {
            Admission::Admitted
        } else if available && now.since(holder.heard) > TIMEOUT {
            Admission::Switched
        } else {
            return Admission::Refused;
        };
        if available {
            *holder = Holder { source, heard: now };
        }
        admission
    }
}

impl Default for SourceLock {
    fn default() -> Self {
        Self::new()
    }
}
