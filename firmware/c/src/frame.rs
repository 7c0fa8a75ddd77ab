//! A classic CAN frame from its parts.

use crate::status::Status;
use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// A frame of the caller's driver.
pub(crate) struct ClassicFrame {
    id: Id,
    length: usize,
    data: [u8; 8],
}

impl ClassicFrame {
    /// Returns the frame; an error if CAN has none such.
    pub(crate) fn from_parts(id: u32, is_extended: bool, data: &[u8]) -> Result<Self, Status> {
        let id = if is_extended {
            ExtendedId::new(id).map(Id::from)
        } else {
            u16::try_from(id)
                .ok()
                .and_then(StandardId::new)
                .map(Id::from)
        };
        Self::new(id.ok_or(Status::Frame)?, data).ok_or(Status::Frame)
    }
}

impl Frame for ClassicFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len(),
            data: bytes,
        })
    }

    /// Remote frames carry nothing: the caller leaves them out.
    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        self.data.get(..self.length).unwrap_or_default()
    }
}
