//! A classic CAN frame in memory.

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::Instant;
use estimator_core::signal::Pgn;

/// ISO 11783-3 / SAE J1939-21: connection management of multi-packet messages.
pub const TRANSPORT_MANAGEMENT: u32 = 60_416;
/// ISO 11783-3 / SAE J1939-21: data of multi-packet messages.
pub const TRANSPORT_DATA: u32 = 60_160;
/// The destination of a broadcast.
const TO_ALL: u32 = 255;

/// A classic CAN frame: 11- or 29-bit identifier, up to 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame {
    id: Id,
    length: u8,
    remote: bool,
    data: [u8; 8],
}

/// A frame and its time of reception.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedFrame {
    /// Time of reception, since the origin of the log.
    pub time: Instant,
    /// The frame.
    pub frame: CanFrame,
}

impl CanFrame {
    /// Creates a frame with a raw 29-bit identifier; `None` if it has more bits, or `data` more
    /// than 8 bytes.
    #[must_use]
    pub fn extended(id: u32, data: &[u8]) -> Option<Self> {
        Self::new(ExtendedId::new(id)?, data)
    }

    /// Creates a frame with a raw 11-bit identifier; `None` as for [`extended`](Self::extended).
    #[must_use]
    pub fn standard(id: u16, data: &[u8]) -> Option<Self> {
        Self::new(StandardId::new(id)?, data)
    }

    /// Returns the frames of a payload that a source sends to all by transport protocol (BAM, SAE
    /// J1939-21): the announcement, and seven bytes in each of the others, the last one padded with
    /// ones. Bytes beyond 1785 are cut off.
    pub fn broadcast(pgn: u32, source: u8, payload: &[u8]) -> impl Iterator<Item = Self> {
        let payload = &payload[..payload.len().min(255 * 7)];
        let [low, high] = (payload.len() as u16).to_le_bytes();
        let [pgn0, pgn1, pgn2, _] = pgn.to_le_bytes();
        let packets = payload.len().div_ceil(7) as u8;
        let announcement = [32, low, high, packets, 0xff, pgn0, pgn1, pgn2];
        let id = move |group: u32| 7 << 26 | group << 8 | u32::from(source);
        let parts = (1_u8..=255).zip(payload.chunks(7)).map(|(number, part)| {
            let mut data = [0xff; 8];
            data[0] = number;
            data[1..=part.len()].copy_from_slice(part);
            data
        });
        let announcement = Self::extended(id(TRANSPORT_MANAGEMENT | TO_ALL), &announcement);
        let parts =
            parts.filter_map(move |data| Self::extended(id(TRANSPORT_DATA | TO_ALL), &data));
        announcement.into_iter().chain(parts)
    }

    /// Returns the group that a frame of the transport protocol announces, and its length in bytes: to
    /// all (control byte 32) or to one receiver (16), SAE J1939-21.
    #[must_use]
    pub fn announcement(&self) -> Option<(u32, u16)> {
        let Id::Extended(id) = self.id() else {
            return None;
        };
        if Pgn::from_raw(id.as_raw()).number != TRANSPORT_MANAGEMENT {
            return None;
        }
        let [16 | 32, low, high, _, _, pgn0, pgn1, pgn2] = *self.data() else {
            return None;
        };
        let announced = u32::from_le_bytes([pgn0, pgn1, pgn2, 0]);
        Some((announced, u16::from_le_bytes([low, high])))
    }

    /// Returns the frames that carry a payload with a raw 29-bit identifier: one frame, or for nine
    /// bytes and more those of an NMEA 2000 fast packet. Each has `sequence`, 0 to 7, and its
    /// number in the first byte; the first frame has the length in its second byte; the last one is
    /// padded with ones. Returns no frame if the identifier has more than 29 bits. Bytes beyond 223
    /// are cut off.
    pub fn carrying(id: u32, sequence: u8, payload: &[u8]) -> impl Iterator<Item = Self> {
        let single = Self::extended(id, payload);
        let packet = if payload.len() > 8 {
            [&[payload.len() as u8], payload].concat()
        } else {
            Vec::new()
        };
        let parts = (0_u8..32).map_while(move |number| {
            let part = packet.chunks(7).nth(number.into())?;
            let mut data = [0xff; 8];
            data[0] = sequence << 5 | number;
            data[1..=part.len()].copy_from_slice(part);
            Self::extended(id, &data)
        });
        single.into_iter().chain(parts)
    }
}

impl Frame for CanFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len() as u8,
            remote: false,
            data: bytes,
        })
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        (dlc <= 8).then(|| Self {
            id: id.into(),
            length: dlc as u8,
            remote: true,
            data: [0; 8],
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        usize::from(self.length)
    }

    fn data(&self) -> &[u8] {
        if self.remote {
            &[]
        } else {
            &self.data[..usize::from(self.length)]
        }
    }
}
