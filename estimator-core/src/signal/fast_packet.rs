//! NMEA 2000 fast packets put together in fixed memory.
//!
//! Byte 0 of each frame holds a 3-bit sequence and a 5-bit frame counter; frame 0 then gives the
//! length and six bytes, each later frame seven. Frames come in order; a packet with a hole is
//! dropped whole.

/// Longest message of interest: PGN 129029 without reference stations (43), and a few with.
const CAPACITY: usize = 64;
/// Messages under way at once.
const SLOTS: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Slot {
    key: u32,
    sequence: u8,
    next_frame: u8,
    length: u8,
    filled: u8,
    bytes: [u8; CAPACITY],
}

/// What a frame did to its packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Assembly {
    /// The packet wants more frames.
    Partial,
    /// The packet is whole.
    Complete,
    /// A frame out of order: it and what it belonged to are dropped.
    OutOfOrder,
    /// Too short to hold what it must.
    Truncated,
}

/// Reassembly of the packets of several senders.
#[derive(Clone, Copy, Debug)]
pub(super) struct FastPackets {
    slots: [Option<Slot>; SLOTS],
    oldest: usize,
}

impl FastPackets {
    pub(super) const fn new() -> Self {
        Self {
            slots: [None; SLOTS],
            oldest: 0,
        }
    }

    /// Takes one frame of the packet `key` (PGN and source address); on [`Assembly::Complete`]
    /// the payload is handed to `whole`. What lies beyond 64 bytes is left out of it.
    pub(super) fn push(&mut self, key: u32, data: &[u8], whole: impl FnOnce(&[u8])) -> Assembly {
        let Some((&head, rest)) = data.split_first() else {
            return Assembly::Truncated;
        };
        let (sequence, frame) = (head >> 5, head & 0x1f);
        if frame == 0 {
            let Some((&length, rest)) = rest.split_first() else {
                return Assembly::Truncated;
            };
            let mut slot = Slot {
                key,
                sequence,
                next_frame: 1,
                length,
                filled: 0,
                bytes: [0; CAPACITY],
            };
            slot.append(rest);
            return self.keep(slot, whole);
        }
        let Some(place) = self
            .slots
            .iter_mut()
            .find(|slot| matches!(slot, Some(s) if s.key == key && s.sequence == sequence))
        else {
            return Assembly::OutOfOrder;
        };
        let Some(slot) = place.as_mut().filter(|slot| slot.next_frame == frame) else {
            *place = None;
            return Assembly::OutOfOrder;
        };
        slot.next_frame += 1;
        slot.append(rest);
        if !slot.is_whole() {
            return Assembly::Partial;
        }
        whole(slot.payload());
        *place = None;
        Assembly::Complete
    }

    fn keep(&mut self, slot: Slot, whole: impl FnOnce(&[u8])) -> Assembly {
        if slot.is_whole() {
            whole(slot.payload());
            return Assembly::Complete;
        }
        // The sender's earlier packet is superseded, else a free place, else the oldest.
        let index = self
            .slots
            .iter()
            .position(|s| matches!(s, Some(s) if s.key == slot.key))
            .or_else(|| self.slots.iter().position(Option::is_none))
            .unwrap_or(self.oldest);
        self.oldest = (index + 1) % SLOTS;
        if let Some(place) = self.slots.get_mut(index) {
            *place = Some(slot);
        }
        Assembly::Partial
    }
}

impl Slot {
    fn append(&mut self, data: &[u8]) {
        let start = usize::from(self.filled);
        if let Some(space) = self.bytes.get_mut(start..) {
            for (to, from) in space.iter_mut().zip(data) {
                *to = *from;
            }
        }
        self.filled = self.filled.saturating_add(data.len().min(7) as u8);
    }

    const fn is_whole(&self) -> bool {
        self.filled >= self.length
    }

    fn payload(&self) -> &[u8] {
        let length = usize::from(self.length).min(CAPACITY);
        self.bytes.get(..length).unwrap_or_default()
    }
}
