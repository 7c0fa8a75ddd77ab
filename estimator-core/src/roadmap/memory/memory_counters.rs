//! What a drive gave.

/// What a drive over known and new roads gave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MemoryCounters {
    /// Finished cells that were added to known ones.
    pub cells_fused: u32,
    /// Finished cells on roads that are driven for the first time.
    pub cells_new: u32,
    /// Finished cells that were left out: the place was not clear, or there was no room.
    pub cells_left_out: u32,
    /// Pages that were written.
    pub writes: u32,
    /// Pages that could not be written.
    pub write_failures: u32,
}
