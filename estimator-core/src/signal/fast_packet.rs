//! Reassembly of NMEA 2000 fast packets in fixed memory.
//!
//! Byte 0 of each frame holds a 3-bit sequence and a 5-bit frame counter; frame 0 then gives the
//! length and six bytes, each later frame seven. Frames come in order; a packet with a missing frame
//! is dropped.

/// Longest payload that is kept: PGN 129029 has 43 bytes, and a few more with reference stations.
const CAPACITY: usize = 64;
/// Number of packets that may be incomplete at once.
const SLOTS: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Slot {
    /// Whether it holds an incomplete packet.
    open: bool,
    key: u32,
    sequence: u8,
    next_frame: u8,
    length: u8,
    filled: u8,
    bytes: [u8; CAPACITY],
}

/// Why a frame does not complete a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unfinished {
    /// More frames must follow.
    Partial,
    /// The frame is out of order. It and its packet are dropped.
    OutOfOrder,
    /// More frames must follow, and the packet before it was never completed.
    CutOff,
    /// The frame is too short for its head.
    Truncated,
}

/// Reassembly of the packets of several senders.
#[derive(Clone, Copy, Debug)]
pub(super) struct FastPackets {
    slots: [Slot; SLOTS],
    oldest: usize,
}

impl FastPackets {
    pub(super) const fn new() -> Self {
        Self {
            slots: [Slot::FREE; SLOTS],
            oldest: 0,
        }
    }

    /// Takes one frame of the packet `key` (PGN and source address). Returns the payload that it
    /// completes, cut at 64 bytes.
    pub(super) fn push(&mut self, key: u32, data: &[u8]) -> Result<&[u8], Unfinished> {
        // Padding of CAN FD frames is not part of the packet.
        let data = data.get(..8).unwrap_or(data);
        let (&head, rest) = data.split_first().ok_or(Unfinished::Truncated)?;
        let (sequence, frame) = (head >> 5, head & 0x1f);
        if frame == 0 {
            let (&length, rest) = rest.split_first().ok_or(Unfinished::Truncated)?;
            let slot = self.slot_for(key).ok_or(Unfinished::OutOfOrder)?;
            let cut_off = slot.open && slot.key == key;
            slot.begin(key, sequence, length);
            let taken = slot.take(rest);
            return match taken {
                Err(Unfinished::Partial) if cut_off => Err(Unfinished::CutOff),
                taken => taken,
            };
        }
        let slot = self
            .slots
            .iter_mut()
            .find(|slot| slot.open && slot.key == key && slot.sequence == sequence)
            .ok_or(Unfinished::OutOfOrder)?;
        if slot.next_frame != frame {
            slot.open = false;
            return Err(Unfinished::OutOfOrder);
        }
        slot.next_frame += 1;
        slot.take(rest)
    }

    /// Returns the slot for a new packet: that of the sender's earlier packet, else a free one, else
    /// the oldest.
    fn slot_for(&mut self, key: u32) -> Option<&mut Slot> {
        let index = self
            .slots
            .iter()
            .position(|slot| slot.open && slot.key == key)
            .or_else(|| self.slots.iter().position(|slot| !slot.open))
            .unwrap_or(self.oldest);
        self.oldest = (index + 1) % SLOTS;
        self.slots.get_mut(index)
    }
}

impl Slot {
    const FREE: Self = Self {
        open: false,
        key: 0,
        sequence: 0,
        next_frame: 0,
        length: 0,
        filled: 0,
        bytes: [0; CAPACITY],
    };

    fn begin(&mut self, key: u32, sequence: u8, length: u8) {
        self.open = true;
        self.key = key;
        self.sequence = sequence;
        self.next_frame = 1;
        self.length = length;
        self.filled = 0;
    }

    /// Appends the data of a frame. Returns the payload if it is complete.
    fn take(&mut self, data: &[u8]) -> Result<&[u8], Unfinished> {
        let start = usize::from(self.filled);
        if let Some(space) = self.bytes.get_mut(start..) {
            for (to, from) in space.iter_mut().zip(data) {
                *to = *from;
            }
        }
        self.filled = self.filled.saturating_add(data.len().min(7) as u8);
        if self.filled < self.length {
            return Err(Unfinished::Partial);
        }
        self.open = false;
        let length = usize::from(self.length).min(CAPACITY);
        Ok(self.bytes.get(..length).unwrap_or_default())
    }
}
