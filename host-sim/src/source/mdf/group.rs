//! A channel group, and the size of its records.

use super::mdf_file::{Block, MdfFile, u16_at, u32_at, u64_at};
use super::records::Size;
use crate::error::Result;

/// Flag of a group whose records are values of variable length.
const VARIABLE_LENGTH: u16 = 1;
/// Flag of a group whose times are those of another one (MDF 4.2).
const REMOTE_MASTER: u16 = 1 << 3;

/// The head of a channel group.
#[derive(Clone, Copy, Debug)]
pub(in crate::source) struct GroupHead {
    /// Its number in front of each record, where a data group has several.
    pub id: u64,
    pub flags: u16,
    /// Bytes of a record without those of invalidation bits.
    pub data_bytes: u32,
    pub invalidation_bytes: u32,
}

impl GroupHead {
    /// Reads the head of a group.
    ///
    /// # Errors
    /// Returns an error for a block that is too short.
    pub(in crate::source) fn read(file: &mut MdfFile, group: &Block) -> Result<Self> {
        let data = file.data(group)?;
        let (Some(id), Some(flags), Some(data_bytes), Some(invalidation_bytes)) = (
            u64_at(&data, 0),
            u16_at(&data, 16),
            u32_at(&data, 24),
            u32_at(&data, 28),
        ) else {
            return Err(file.error("a channel group without its fields", "32 bytes"));
        };
        Ok(Self {
            id,
            flags,
            data_bytes,
            invalidation_bytes,
        })
    }

    /// Returns the size of its records.
    pub(in crate::source) const fn size(&self) -> Size {
        if self.flags & VARIABLE_LENGTH != 0 {
            return Size::Variable;
        }
        let bytes = self.data_bytes.saturating_add(self.invalidation_bytes);
        Size::Fixed(bytes as usize)
    }

    /// Returns true if the times of its records are those of another group.
    pub(in crate::source) const fn has_remote_master(&self) -> bool {
        self.flags & REMOTE_MASTER != 0
    }
}
