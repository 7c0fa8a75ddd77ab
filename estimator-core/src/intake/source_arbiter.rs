//! Source arbitration: one source owns each signal.
//!
//! Two controllers may send the same parameter group (a brake and an engine controller both send
//! CCVS1), and two groups the same signal (a position comes in 129025 and in 129029). Mixing them
//! would add their offsets as noise. For 10 s the lowest source address wins; after that the first
//! owner keeps the signal. After a silence of 5 s another source may stand in; the owner takes the
//! signal back when it sends again.
//!
//! A truck may have two retarders, one at the engine and one at the gearbox. Each reports its own
//! torque, so retarder torque has no owner.
//!
//! Where one sender reports the air pressure in two messages, that with the finer steps (AMB2) has the
//! lower number, and wins. An acceleration with finer steps (ACCS before VDC2) has the higher number,
//! and wins whoever sends it.
//!
//! What an engine says of itself counts if it comes from the controller whose torque is used. A bus
//! may have two: the other one is a gateway's, or that of a second engine.
//!
//! A signal that the caller gives without a bus, from a message of its own, can be reserved. Then no
//! sender owns it.
//!
//! Which controller starts first is chance. J1939 gives the lowest addresses to the controllers that
//! measure (engine 0, gearbox 3, brakes 11), and those above 127 to whatever asks for one.

use crate::signal::Signal;
use crate::time::{Duration, Instant};
use crate::tuning::HoldTimes;

/// Whether a reading comes from the source that owns its signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// It comes from the source in use.
    Admitted,
    /// It comes from the owner, and the last one did not. Its offset may differ.
    Switched,
    /// It comes from a source that stands in for the owner, and the last one did not.
    StoodIn,
    /// Another source owns the signal.
    Refused,
    /// The signal is left out, whatever its source.
    Ignored,
}

/// The source of a signal: an address, and the message it is sent in.
///
/// It is stored as its complement, so that no sender is zero: an image then clears the table of
/// owners instead of writing out each entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender(u16);

impl Sender {
    /// No sender: there are not so many messages.
    const NONE: Self = Self::of(u16::MAX);
    /// The caller of the estimator, which gives the readings of a reserved signal itself.
    const CALLER: Self = Self::of(u16::MAX - 2);
    /// The owner of a signal that is left out: there are not so many messages.
    const NOBODY: Self = Self::of(u16::MAX - 1);

    const fn of(number: u16) -> Self {
        Self(!number)
    }

    /// Returns the message and, in the low byte, the address.
    const fn number(self) -> u16 {
        !self.0
    }

    const fn address(self) -> u8 {
        self.number() as u8
    }

    const fn message(self) -> u8 {
        (self.number() >> 8) as u8
    }

    /// Creates the sender with this address, in the message with this index.
    #[must_use]
    pub const fn new(message: usize, address: u8) -> Self {
        Self::of(((message as u16) << 8) | address as u16)
    }
}

#[derive(Clone, Copy, Debug)]
struct Ownership {
    /// The source in use.
    sender: Sender,
    /// The source that takes the signal whenever it sends.
    owner: Sender,
    /// The low 32 bits of the time, µs. They come round after 71 minutes: a source that was silent for
    /// that long, and by chance for little more, may keep the signal for some seconds.
    last_seen_us: u32,
}

impl Ownership {
    fn seen(&mut self, now: Instant) {
        self.last_seen_us = now.micros() as u32;
    }

    fn silence(&self, now: Instant) -> Duration {
        let silence_us = (now.micros() as u32).wrapping_sub(self.last_seen_us);
        Duration::from_micros(u64::from(silence_us))
    }
}

/// The owner of each signal.
#[derive(Clone, Debug)]
pub struct SourceArbiter {
    signals: [Ownership; Signal::ALL.len()],
    started: Option<Instant>,
}

impl SourceArbiter {
    /// Creates the arbiter before the first reading.
    #[must_use]
    pub const fn new() -> Self {
        let none = Ownership {
            sender: Sender::NONE,
            owner: Sender::NONE,
            last_seen_us: 0,
        };
        Self {
            signals: [none; Signal::ALL.len()],
            started: None,
        }
    }

    /// Reserves a signal for readings that come without a bus: from now on, no sender owns it. One
    /// that is left out stays so.
    pub fn reserve(&mut self, signal: Signal) {
        if let Some(ownership) = self.signals.get_mut(signal as usize)
            && ownership.owner != Sender::NOBODY
        {
            ownership.sender = Sender::CALLER;
            ownership.owner = Sender::CALLER;
        }
    }

    /// Leaves out a signal from now on, whatever its source.
    pub fn ignore(&mut self, signal: Signal) {
        if let Some(ownership) = self.signals.get_mut(signal as usize) {
            ownership.sender = Sender::NOBODY;
            ownership.owner = Sender::NOBODY;
        }
    }

    /// Returns whether a signal is left out.
    #[must_use]
    pub fn is_ignored(&self, signal: Signal) -> bool {
        let ownership = self.signals.get(signal as usize);
        ownership.is_some_and(|ownership| ownership.owner == Sender::NOBODY)
    }

    /// Decides whether a reading of `signal` counts. Only a measurement (`available`) takes or keeps
    /// a signal.
    pub fn admit(
        &mut self,
        signal: Signal,
        sender: Sender,
        now: Instant,
        available: bool,
        tuning: &HoldTimes,
    ) -> Admission {
        if signal == Signal::RetarderTorque {
            let ownership = self.signals.get(signal as usize);
            return match ownership.map(|ownership| ownership.owner) {
                Some(Sender::NOBODY) => Admission::Ignored,
                Some(Sender::CALLER) => Admission::Refused,
                _ => Admission::Admitted,
            };
        }
        let Some(ownership) = self.signals.get_mut(signal as usize) else {
            return Admission::Refused;
        };
        if ownership.sender == sender {
            if available {
                ownership.seen(now);
            }
            return Admission::Admitted;
        }
        self.admit_other(signal, sender, now, available, tuning)
    }

    /// Decides on a reading of another source than the one in use.
    #[inline(never)] // Not on the path of every reading.
    fn admit_other(
        &mut self,
        signal: Signal,
        sender: Sender,
        now: Instant,
        available: bool,
        tuning: &HoldTimes,
    ) -> Admission {
        let started = *self.started.get_or_insert(now);
        let is_start = now.since(started) < tuning.start;
        let engine = self.signals.get(Signal::EngineTorque as usize);
        let is_of_engine = engine.is_some_and(|of| of.sender.address() == sender.address());
        let Some(ownership) = self.signals.get_mut(signal as usize) else {
            return Admission::Refused;
        };
        match signal {
            _ if ownership.owner == Sender::NOBODY => Admission::Ignored,
            _ if ownership.owner == Sender::CALLER => Admission::Refused,
            Signal::EngineReferenceTorque | Signal::EngineInertia if is_of_engine => {
                ownership.sender = sender;
                Admission::Admitted
            }
            Signal::EngineReferenceTorque | Signal::EngineInertia => Admission::Refused,
            _ => {
                let owner = ownership.owner;
                let is_finer = signal == Signal::AirPressure && sender.number() < owner.number();
                let precedes = match signal {
                    Signal::LongitudinalAcceleration if sender.message() != owner.message() => {
                        sender.message() > owner.message()
                    }
                    _ => {
                        sender.address() < owner.address()
                            || is_finer && sender.address() == owner.address()
                    }
                };
                ownership.hand_over(sender, now, available, is_start && precedes, tuning)
            }
        }
    }
}

impl Ownership {
    /// Decides whether another source takes the signal.
    fn hand_over(
        &mut self,
        sender: Sender,
        now: Instant,
        available: bool,
        precedes: bool,
        tuning: &HoldTimes,
    ) -> Admission {
        let is_free = self.sender == Sender::NONE;
        if !available {
            return if is_free {
                Admission::Admitted
            } else {
                Admission::Refused
            };
        }
        let returns = sender == self.owner;
        if is_free || precedes {
            self.owner = sender;
        } else if !returns && self.silence(now) <= tuning.state_timeout {
            return Admission::Refused;
        }
        self.sender = sender;
        self.seen(now);
        if is_free {
            Admission::Admitted
        } else if sender == self.owner {
            Admission::Switched
        } else {
            Admission::StoodIn
        }
    }
}

impl Default for SourceArbiter {
    fn default() -> Self {
        Self::new()
    }
}
