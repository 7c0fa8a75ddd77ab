//! Addresses of blocks in a road memory: they stay when a page is written to another sector.

/// Bits of the number of a block within its page, and of the slot.
const BLOCK_BITS: u32 = 8;
const SLOT_BITS: u32 = 12;

/// What a page is: the slot that it fills, and how many pages have filled this slot before. Another
/// page in the slot has another key, so an address never leads to a wrong page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PageKey {
    /// Slot, below 4096.
    pub slot: u16,
    /// Pages that have filled it before, modulo 4096.
    pub generation: u16,
}

impl PageKey {
    /// Returns the key of the page with an address.
    #[must_use]
    pub const fn of(address: u32) -> Self {
        Self {
            slot: ((address >> BLOCK_BITS) & ((1 << SLOT_BITS) - 1)) as u16,
            generation: (address >> (BLOCK_BITS + SLOT_BITS)) as u16,
        }
    }

    /// Returns the address of a block of this page.
    #[must_use]
    pub const fn block(self, number: u8) -> u32 {
        ((self.generation as u32) << (BLOCK_BITS + SLOT_BITS))
            | ((self.slot as u32) << BLOCK_BITS)
            | number as u32
    }

    /// Returns the key of the page that fills the slot after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        Self {
            slot: self.slot,
            // Zero is that of no page.
            generation: self.generation % 0xfff + 1,
        }
    }
}

/// Returns the number of a block within its page.
#[must_use]
pub const fn block_number(address: u32) -> u8 {
    address as u8
}
