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

/// Who sends a signal: an address, and in which message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender(u16);

impl Sender {
    /// Of no message: there are not so many.
    const NOBODY: Self = Self(u16::MAX);

    /// In the message with this index.
    #[must_use]
    pub const fn new(message: usize, address: u8) -> Self {
        Self(((message as u16) << 8) | address as u16)
    }
}

#[derive(Clone, Copy, Debug)]
struct Holder {
    sender: Sender,
    heard: Instant,
}

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
            sender: Sender::NOBODY,
            heard: Instant::ZERO,
        };
        Self {
            holders: [nobody; Signal::ALL.len()],
        }
    }

    /// Whether a reading of `signal` counts. Only a measurement (`available`) takes or keeps the
    /// word.
    pub fn admit(
        &mut self,
        signal: Signal,
        sender: Sender,
        now: Instant,
        available: bool,
    ) -> Admission {
        if signal == Signal::RetarderTorque {
            return Admission::Admitted;
        }
        let Some(holder) = self.holders.get_mut(signal as usize) else {
            return Admission::Refused;
        };
        let admission = if holder.sender == sender || holder.sender == Sender::NOBODY {
            Admission::Admitted
        } else if available && now.since(holder.heard) > TIMEOUT {
            Admission::Switched
        } else {
            return Admission::Refused;
        };
        if available {
            *holder = Holder { sender, heard: now };
        }
        admission
    }
}

impl Default for SourceLock {
    fn default() -> Self {
        Self::new()
    }
}
