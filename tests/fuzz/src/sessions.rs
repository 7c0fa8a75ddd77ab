//! Frames of the transport protocol made of arbitrary bytes, and a reference that keeps everything.

use arbitrary::Arbitrary;
use host_sim::source::can_frame::{CanFrame, TRANSPORT_DATA, TRANSPORT_MANAGEMENT};
use std::collections::HashMap;

/// Control bytes that mean something, and one that does not.
const CONTROLS: [u8; 6] = [16, 17, 19, 32, 255, 7];
/// Groups that are announced: the first two are decoded.
const GROUPS: [u32; 4] = [65_251, 65_249, 65_226, 129_029];
const BROADCAST: u8 = 32;
const REQUEST_TO_SEND: u8 = 16;

/// A frame of the protocol.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Packet {
    pub source: u8,
    pub to_all: bool,
    /// Time since the frame before, ms.
    pub wait_ms: u16,
    pub is_data: bool,
    /// Number of the packet, or what chooses the control byte and the group.
    pub number: u8,
    /// Announced length, bytes.
    pub length: u16,
    /// Added to the number of packets that the length needs.
    pub more_packets: u8,
    /// Bytes of the frame, modulo 9.
    pub size: u8,
    pub data: [u8; 7],
}

impl Packet {
    /// Returns the frame: the sender is one of four, and so is the receiver.
    #[must_use]
    pub fn frame(&self) -> Option<CanFrame> {
        let (source, destination) = self.pair();
        let mut bytes = [self.number; 8];
        let group = if self.is_data {
            bytes[1..].copy_from_slice(&self.data);
            TRANSPORT_DATA
        } else {
            let [low, high] = self.length.to_le_bytes();
            let [pgn0, pgn1, pgn2, _] = self.group().to_le_bytes();
            let control = CONTROLS[usize::from(self.number) % CONTROLS.len()];
            bytes = [control, low, high, self.packets(), 0xff, pgn0, pgn1, pgn2];
            TRANSPORT_MANAGEMENT
        };
        let id = 7 << 26 | (group | u32::from(destination)) << 8 | u32::from(source);
        CanFrame::extended(id, &bytes[..usize::from(self.size % 9)])
    }

    fn pair(&self) -> (u8, u8) {
        let destination = if self.to_all {
            255
        } else {
            self.source >> 2 & 3
        };
        (self.source & 3, destination)
    }

    fn group(&self) -> u32 {
        GROUPS[usize::from(self.number) / CONTROLS.len() % GROUPS.len()]
    }

    fn packets(&self) -> u8 {
        (self.length.div_ceil(7) as u8).wrapping_add(self.more_packets)
    }
}

/// The last announcement of each pair, and the packets that came since.
#[derive(Debug, Default)]
pub struct Reference(HashMap<(u8, u8), Announced>);

#[derive(Debug)]
struct Announced {
    group: u32,
    length: usize,
    packets: HashMap<u8, Vec<u8>>,
}

impl Reference {
    /// Takes a packet as it was sent.
    pub fn take(&mut self, packet: &Packet, bytes: &[u8]) {
        let Some((&head, rest)) = bytes.split_first() else {
            return;
        };
        if packet.is_data {
            if let Some(announced) = self.0.get_mut(&packet.pair()) {
                announced.packets.insert(head, rest.to_vec());
            }
        } else if bytes.len() == 8 && [BROADCAST, REQUEST_TO_SEND].contains(&head) {
            let announced = Announced {
                group: packet.group(),
                length: packet.length.into(),
                packets: HashMap::new(),
            };
            self.0.insert(packet.pair(), announced);
        }
    }

    /// Returns the payload that the pair of a packet has sent, with ones behind its end, if the group
    /// is that which it announced.
    #[must_use]
    pub fn payload(&self, packet: &Packet, group: u32) -> Option<Vec<u8>> {
        let announced = self.0.get(&packet.pair())?;
        if announced.group != group {
            return None;
        }
        let mut payload = Vec::new();
        for number in 1..=announced.length.div_ceil(7) as u8 {
            payload.extend(announced.packets.get(&number)?);
        }
        payload.truncate(announced.length);
        payload.resize(payload.len().max(64), 0xff);
        Some(payload)
    }
}
