//! One source for each signal: who came first keeps the word, and gets it back after a silence in
//! which another stood in.
//!
//! Two controllers may send the same parameter group (a brake and an engine controller both send
//! CCVS1), and two groups the same signal (a position comes in 129025 and in 129029). Mixing
//! them would add their offsets as noise. A truck may have two retarders, though, one at the engine
//! and one at the gearbox, and each tells of its own: they all have the word.
//!
//! Which controller starts up first is chance, and a stranger may have been there before. In the
//! first seconds of a drive the lowest address has the word: J1939 gives the lowest ones to those
//! that measure (engine 0, gearbox 3, brakes 11) and those above 127 to whoever asks.

use super::Signal;
use crate::time::{Duration, Instant};

/// Silence after which another source may stand in.
const TIMEOUT: Duration = Duration::from_millis(5000);
/// Time from the first reading on in which controllers start up.
const START: Duration = Duration::from_millis(10_000);

/// Whether a reading comes from the source that has the word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// From the source in use.
    Admitted,
    /// From another source than the last one in use: an offset may have come with it.
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

    const fn address(self) -> u8 {
        self.0 as u8
    }

    /// In the message with this index.
    #[must_use]
    pub const fn new(message: usize, address: u8) -> Self {
        Self(((message as u16) << 8) | address as u16)
    }
}

#[derive(Clone, Copy, Debug)]
struct Holder {
    sender: Sender,
    /// Who has the word whenever it speaks.
    rightful: Sender,
    heard: Instant,
}

/// The source heard for each signal.
#[derive(Clone, Debug)]
pub struct SourceLock {
    holders: [Holder; Signal::ALL.len()],
    started: Option<Instant>,
}

impl SourceLock {
    /// Nobody heard yet.
    #[must_use]
    pub const fn new() -> Self {
        let nobody = Holder {
            sender: Sender::NOBODY,
            rightful: Sender::NOBODY,
            heard: Instant::ZERO,
        };
        Self {
            holders: [nobody; Signal::ALL.len()],
            started: None,
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
        if holder.sender == sender {
            if available {
                holder.heard = now;
            }
            return Admission::Admitted;
        }
        let started = *self.started.get_or_insert(now);
        holder.hand_over(sender, now, available, now.since(started) < START)
    }
}

impl Holder {
    /// Another than the one with the word speaks.
    #[inline(never)] // Not where each reading passes.
    fn hand_over(
        &mut self,
        sender: Sender,
        now: Instant,
        available: bool,
        starts: bool,
    ) -> Admission {
        let nobody = self.sender == Sender::NOBODY;
        if !available {
            return if nobody {
                Admission::Admitted
            } else {
                Admission::Refused
            };
        }
        let precedes = starts && sender.address() < self.rightful.address();
        let returns = sender == self.rightful;
        if nobody || precedes {
            self.rightful = sender;
        } else if !returns && now.since(self.heard) <= TIMEOUT {
            return Admission::Refused;
        }
        self.sender = sender;
        self.heard = now;
        if nobody {
            Admission::Admitted
        } else {
            Admission::Switched
        }
    }
}

impl Default for SourceLock {
    fn default() -> Self {
        Self::new()
    }
}
