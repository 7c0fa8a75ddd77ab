//! The flash memory that holds the roads.

use embedded_storage::nor_flash::NorFlash;

/// Bytes of a sector: what is erased and written at once.
pub const SECTOR_BYTES: usize = 4096;
/// Bytes that are written in one call; a multiple of what any flash memory writes at once.
pub(super) const CHUNK_BYTES: usize = 256;
/// Fewest sectors. Two stay free, so that a page is never written over its older copy, and three are
/// changed at the same time.
pub const FEWEST_SECTORS: usize = 8;
/// Most sectors that an address can name: 16 MiB.
pub const MOST_SECTORS: usize = 4096;

/// A NOR flash memory whose bytes the processor reads in place, as it reads its program: internal
/// flash, or a serial one that is mapped into memory.
///
/// It erases sectors of 4096 bytes or smaller ones, and writes units of 256 bytes or smaller ones.
pub trait MappedFlash: NorFlash {
    /// Returns all bytes, as they are now.
    fn bytes(&self) -> &[u8];
}

/// Returns the bytes of a sector; `None` beyond the last one.
pub(super) fn sector_bytes(flash: &[u8], sector: u16) -> Option<&[u8]> {
    let start = usize::from(sector) * SECTOR_BYTES;
    flash.get(start..start + SECTOR_BYTES)
}
