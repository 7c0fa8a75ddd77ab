//! Reassembly of multi-packet messages of J1939 (transport protocol, SAE J1939-21) in fixed memory.
//!
//! An announcement (TP.CM) names the PGN, the length and the number of packets; data frames (TP.DT)
//! follow with a packet number from 1 and seven bytes each. Data frames do not name the PGN: a
//! sender has one session for each destination. Sessions are to all (BAM) or to one receiver (RTS
//! and CTS). The decoder listens to both and answers neither. It keeps sessions of known messages
//! only, and of these the bytes that signals lie in.
//!
//! Packets come in order. A session with a missing packet is dropped. A packet that comes twice with
//! the same bytes counts once: a receiver may ask for it again.

use super::frame_outcome::{FrameOutcome, Pgn, Rejection};
use super::layout::{Framing, MESSAGES, Message, index_of};
use crate::time::Instant;

/// Parameter group of announcements (TP.CM).
const MANAGEMENT: u32 = 60_416;
/// Parameter group of data (TP.DT). The build script knows both numbers.
const DATA: u32 = 60_160;

/// Control bytes of announcements: a request to send, the end of a session to one receiver, a
/// broadcast, an abort.
const REQUEST_TO_SEND: u8 = 16;
const END_ACKNOWLEDGED: u8 = 19;
const BROADCAST: u8 = 32;
const ABORT: u8 = 255;

/// The destination of a broadcast.
const TO_ALL: u8 = 255;
/// Bytes in a data frame.
const PACKET: usize = 7;
/// Lengths of multi-packet messages, bytes.
const LENGTHS: core::ops::RangeInclusive<u16> = 9..=1_785;
/// Longest pause within a session, µs: T1 to all, T2 and T3 to one receiver.
const PAUSE_TO_ALL_US: u32 = 750_000;
const PAUSE_TO_ONE_US: u32 = 1_250_000;

/// Bytes that are kept of a message: EC1's inertia ends there.
pub(super) const CAPACITY: usize = 32;
/// Number of sessions that may be open at once: of two engines and two retarders.
const SLOTS: usize = 4;

const _: () = {
    let mut index = 0;
    while index < MESSAGES.len() {
        let message = &MESSAGES[index];
        let fits = message.end_bit as usize <= 8 * CAPACITY;
        assert!(fits || !matches!(message.framing, Framing::Transport));
        index += 1;
    }
};

/// Source and destination of an identifier. Together they identify a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pair {
    source: u8,
    destination: u8,
}

impl Pair {
    const fn of(id: u32) -> Self {
        Self {
            source: id as u8,
            destination: (id >> 8) as u8,
        }
    }

    const fn reversed(self) -> Self {
        Self {
            source: self.destination,
            destination: self.source,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Session {
    open: bool,
    pair: Pair,
    /// Index of its message.
    message: u8,
    /// Number of packets in all, and of the next one, from 1.
    packets: u8,
    next: u8,
    /// Bytes to keep.
    length: u8,
    /// Time of its newest frame: the low 32 bits, µs. With all of them, what is read with every frame
    /// would lie behind the sessions, where a controller reaches it by a longer way.
    time_us: u32,
    /// The payload, with ones ("not available") where the message is shorter.
    bytes: [u8; CAPACITY],
}

/// A message that is complete: its index, its layout, and its payload up to 32 bytes.
type Complete<'a> = (usize, &'static Message, &'a [u8]);

/// Sessions of several senders.
#[derive(Clone, Copy, Debug)]
pub(super) struct TransportSessions {
    sessions: [Session; SLOTS],
    oldest: usize,
}

impl TransportSessions {
    pub(super) const fn new() -> Self {
        Self {
            sessions: [Session::CLOSED; SLOTS],
            oldest: 0,
        }
    }

    /// Takes one frame of the group `pgn` with this identifier, received at `now`. Returns the message
    /// that it completes.
    ///
    /// # Errors
    /// What became of a frame that completes none.
    #[inline(never)] // Rare.
    pub(super) fn push(
        &mut self,
        now: Instant,
        pgn: Pgn,
        id: u32,
        data: &[u8],
    ) -> Result<Complete<'_>, FrameOutcome> {
        let pair = Pair::of(id);
        match pgn.number {
            MANAGEMENT => Err(self.manage(now, pair, data)),
            DATA => self.data(now, pair, data),
            _ => Err(FrameOutcome::Ignored),
        }
    }

    fn manage(&mut self, now: Instant, pair: Pair, data: &[u8]) -> FrameOutcome {
        let Some(&[control, low, high, packets, _, pgn0, pgn1, pgn2]) = data.first_chunk() else {
            return FrameOutcome::Rejected(Rejection::Truncated);
        };
        let pgn = u32::from_le_bytes([pgn0, pgn1, pgn2, 0]);
        let is_cut_off = match control {
            BROADCAST | REQUEST_TO_SEND => self.close(pair),
            ABORT | END_ACKNOWLEDGED => self.close(pair) | self.close(pair.reversed()),
            _ => return FrameOutcome::Ignored,
        };
        let unfinished = if is_cut_off {
            FrameOutcome::Rejected(Rejection::TransportOrder)
        } else {
            FrameOutcome::Partial
        };
        let message = index_of(pgn).filter(|index| {
            let message = MESSAGES.get(*index);
            message.is_some_and(|message| message.framing == Framing::Transport)
        });
        let Some(message) = message.filter(|_| control == BROADCAST || control == REQUEST_TO_SEND)
        else {
            return if is_cut_off {
                unfinished
            } else {
                FrameOutcome::Ignored
            };
        };
        let length = u16::from_le_bytes([low, high]);
        let is_sound = LENGTHS.contains(&length)
            && u16::from(packets) == length.div_ceil(PACKET as u16)
            && (control == BROADCAST) == (pair.destination == TO_ALL);
        if !is_sound {
            return FrameOutcome::Rejected(Rejection::TransportAnnouncement);
        }
        if let Some(session) = self.free_session(now) {
            session.open = true;
            session.pair = pair;
            session.message = message as u8;
            session.packets = packets;
            session.next = 1;
            session.length = length.min(CAPACITY as u16) as u8;
            session.time_us = now.micros() as u32;
            session.bytes = [0xff; CAPACITY];
        }
        unfinished
    }

    fn data(
        &mut self,
        now: Instant,
        pair: Pair,
        data: &[u8],
    ) -> Result<Complete<'_>, FrameOutcome> {
        let Some(session) = self.session_of(pair) else {
            // Of another message, or of a session that was dropped.
            return Err(FrameOutcome::Ignored);
        };
        let taken = session.take(now, data);
        // Closed by each but a part: whole, or unusable.
        session.open = matches!(taken, Err(FrameOutcome::Partial));
        taken?;
        let index = usize::from(session.message);
        let message = MESSAGES.get(index).ok_or(FrameOutcome::Ignored)?;
        Ok((index, message, &session.bytes))
    }

    /// Closes the session of a pair. Returns whether there was one.
    fn close(&mut self, pair: Pair) -> bool {
        let session = self.session_of(pair);
        session.is_some_and(|session| core::mem::replace(&mut session.open, false))
    }

    #[inline(never)]
    fn session_of(&mut self, pair: Pair) -> Option<&mut Session> {
        self.sessions.iter_mut().find(|of| of.is_of(pair))
    }

    /// Returns a session that is closed or was given up, else the oldest.
    fn free_session(&mut self, now: Instant) -> Option<&mut Session> {
        let index = self
            .sessions
            .iter()
            .position(|of| !of.open || of.is_given_up(now))
            .unwrap_or(self.oldest);
        self.oldest = (index + 1) % SLOTS;
        self.sessions.get_mut(index)
    }
}

impl Session {
    const CLOSED: Self = Self {
        open: false,
        pair: Pair {
            source: 0,
            destination: 0,
        },
        message: 0,
        packets: 0,
        next: 0,
        length: 0,
        time_us: 0,
        bytes: [0; CAPACITY],
    };

    fn is_of(&self, pair: Pair) -> bool {
        self.open && self.pair == pair
    }

    fn is_given_up(&self, now: Instant) -> bool {
        let longest_us = if self.pair.destination == TO_ALL {
            PAUSE_TO_ALL_US
        } else {
            PAUSE_TO_ONE_US
        };
        (now.micros() as u32).wrapping_sub(self.time_us) > longest_us
    }

    /// Appends a packet. Returns `Ok` if it is the last one.
    fn take(&mut self, now: Instant, data: &[u8]) -> Result<(), FrameOutcome> {
        let (Some(&[number, ..]), Some(packet)) = (data.first_chunk::<1>(), data.get(1..)) else {
            return Err(FrameOutcome::Rejected(Rejection::Truncated));
        };
        let broken = Err(FrameOutcome::Rejected(Rejection::TransportOrder));
        if number == 0 || number > self.next || self.is_given_up(now) {
            return broken;
        }
        let start = PACKET * (usize::from(number) - 1);
        let kept = usize::from(self.length).saturating_sub(start).min(PACKET);
        let Some(packet) = packet.get(..kept) else {
            return Err(FrameOutcome::Rejected(Rejection::Truncated));
        };
        let place = self.bytes.get_mut(start..).unwrap_or_default();
        let place = place.get_mut(..kept).unwrap_or_default();
        if number < self.next {
            return if place == packet {
                Err(FrameOutcome::Partial)
            } else {
                broken
            };
        }
        for (to, from) in place.iter_mut().zip(packet) {
            *to = *from;
        }
        self.time_us = now.micros() as u32;
        if number == self.packets {
            return Ok(());
        }
        self.next += 1;
        Err(FrameOutcome::Partial)
    }
}
