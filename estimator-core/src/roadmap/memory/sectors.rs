//! What is known of each sector and of each slot, in RAM that the caller gives.

use super::page::PageHeader;
use crate::roadmap::tile::TileBounds;

/// No slot, no sector.
const NONE: u16 = u16::MAX;
/// Held by a page that another release wrote.
const FOREIGN: u16 = u16::MAX - 1;
/// Drives by which each further drive over a page keeps it longer, and the most that count.
const DRIVES_KEPT: u32 = 8;
const MOST_DRIVES: u16 = 50;

/// What is known of a sector and, independently of it, of the page in the slot with the same number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sector {
    /// Times that the sector was erased.
    pub(super) erases: u32,
    /// The slot whose page the sector holds.
    held: u16,
    /// The sector that holds the page of the slot.
    sector: u16,
    /// Pages that have filled the slot before this one.
    pub(super) generation: u16,
    drives: u16,
    last_drive: u32,
    pub(super) bounds: TileBounds,
}

/// What is known of all sectors, in RAM that the caller gives: an array, a slice or a vector.
pub trait SectorTable: AsRef<[Sector]> + AsMut<[Sector]> {}

impl<T: AsRef<[Sector]> + AsMut<[Sector]>> SectorTable for T {}

impl Default for Sector {
    /// Returns a sector that is free, and a slot without a page.
    fn default() -> Self {
        Self {
            erases: 0,
            held: NONE,
            sector: NONE,
            generation: 0,
            drives: 0,
            last_drive: 0,
            bounds: TileBounds::default(),
        }
    }
}

impl Sector {
    /// Returns the sector that holds the page of the slot.
    pub(super) fn page_sector(&self) -> Option<u16> {
        (self.sector != NONE).then_some(self.sector)
    }

    /// Returns whether the sector holds no page that counts.
    pub(super) const fn is_free(&self) -> bool {
        self.held == NONE
    }

    /// Returns whether the sector holds a page that another release wrote.
    pub(super) const fn is_foreign(&self) -> bool {
        self.held == FOREIGN
    }

    /// Marks the sector as one with a page that another release wrote, or as free again.
    pub(super) const fn set_foreign(&mut self, is_foreign: bool) {
        self.held = if is_foreign { FOREIGN } else { NONE };
    }

    /// Returns how long the page of the slot is worth keeping: the number of the drive that last
    /// changed it, and more for each other drive.
    fn worth(&self) -> u32 {
        let others = u32::from(self.drives.min(MOST_DRIVES).saturating_sub(1));
        self.last_drive.saturating_add(DRIVES_KEPT * others)
    }
}

/// Notes that a sector holds the page with this header now.
pub(super) fn hold(sectors: &mut [Sector], sector: u16, header: &PageHeader) {
    let slot = header.key.slot;
    let Some(of_slot) = sectors.get_mut(usize::from(slot)) else {
        return;
    };
    let older = core::mem::replace(&mut of_slot.sector, sector);
    of_slot.generation = header.key.generation;
    of_slot.drives = header.drives;
    of_slot.last_drive = header.last_drive;
    of_slot.bounds = header.bounds;
    if let Some(older) = sectors.get_mut(usize::from(older)) {
        older.held = NONE;
    }
    if let Some(newer) = sectors.get_mut(usize::from(sector)) {
        newer.held = slot;
    }
}

/// Returns the slot whose page is least worth keeping.
pub(super) fn least_useful(sectors: &[Sector], is_needed: impl Fn(u16) -> bool) -> Option<u16> {
    (0_u16..)
        .zip(sectors)
        .filter(|(slot, of_slot)| of_slot.sector != NONE && !is_needed(*slot))
        .min_by_key(|(_, of_slot)| of_slot.worth())
        .map(|(slot, _)| slot)
}
