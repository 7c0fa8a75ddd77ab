//! A classic CAN frame in memory.

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use estimator_core::Instant;

/// A classic CAN frame: 11- or 29-bit identifier, up to 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame {
    id: Id,
    length: u8,
    remote: bool,
    data: [u8; 8],
}

/// A frame and when it was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedFrame {
    /// Reception, from the log's own origin.
    pub time: Instant,
    /// What was received.
    pub frame: CanFrame,
}

impl CanFrame {
    /// A frame with a raw 29-bit identifier; `None` if it has more bits or `data` more than 8
    /// bytes.
    #[must_use]
    pub fn extended(id: u32, data: &[u8]) -> Option<Self> {
        Self::new(ExtendedId::new(id)?, data)
    }

    /// A frame with a raw 11-bit identifier; `None` as for [`extended`](Self::extended).
    #[must_use]
    pub fn standard(id: u16, data: &[u8]) -> Option<Self> {
        Self::new(StandardId::new(id)?, data)
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
