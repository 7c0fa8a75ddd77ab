//! Pages in flash. A page that changes is written to a free sector. Its older copy stays until then
//! and counts if the power is lost.

use super::address::PageKey;
use super::flash::{CHUNK_BYTES, FEWEST_SECTORS, MOST_SECTORS, MappedFlash, SECTOR_BYTES};
use super::page::{NoPage, Page, PageHeader};
use super::page_buffer::PageBuffer;
use super::sectors::{Sector, hold, least_useful};
use super::view::MemoryView;
use core::fmt;

/// Sectors that stay free.
const SPARE: usize = 2;
/// Difference of erase counts from which a page moves to a worn sector.
const UNEVEN_ERASES: u32 = 16;
/// Erase count of a sector that could not be written: it is used last.
const WORN_OUT: u32 = u32::MAX / 2;

/// Why a road memory does not work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryError<E> {
    /// The flash memory has too few sectors, or too many, or RAM was given for fewer.
    Size,
    /// The flash memory says this.
    Flash(E),
    /// A sector does not hold what was written to it.
    Worn,
}

impl<E: fmt::Debug> fmt::Display for MemoryError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => f.write_str("a road memory has 8 to 4096 sectors of 4096 bytes"),
            Self::Flash(error) => write!(f, "the flash memory fails: {error:?}"),
            Self::Worn => f.write_str("a sector does not hold what was written to it"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for MemoryError<E> {}

/// What a road memory held when it was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Opened {
    /// Pages that count.
    pub pages: u32,
    /// Pages that another release wrote. They are not read, and are overwritten last.
    pub other_version: u32,
    /// Sectors that are damaged, or were not written to their end.
    pub damaged: u32,
}

/// Pages in flash.
#[derive(Clone, Debug)]
pub(super) struct Store<F, R> {
    flash: F,
    sectors: R,
    sequence: u32,
    /// Number of this drive.
    pub(super) drive: u32,
    opened: Opened,
}

impl<F: MappedFlash, R: AsRef<[Sector]> + AsMut<[Sector]>> Store<F, R> {
    /// Reads what a flash memory holds.
    pub(super) fn open(flash: F, sectors: R) -> Result<Self, MemoryError<F::Error>> {
        let count = flash.bytes().len() / SECTOR_BYTES;
        let is_possible = (FEWEST_SECTORS..=MOST_SECTORS).contains(&count)
            && sectors.as_ref().len() == count
            && SECTOR_BYTES.is_multiple_of(F::ERASE_SIZE)
            && CHUNK_BYTES.is_multiple_of(F::WRITE_SIZE);
        if !is_possible {
            return Err(MemoryError::Size);
        }
        let mut store = Self {
            flash,
            sectors,
            sequence: 0,
            drive: 1,
            opened: Opened::default(),
        };
        store.scan();
        Ok(store)
    }

    fn scan(&mut self) {
        self.sectors.as_mut().fill(Sector::default());
        let (mut known, mut sum) = (0_u32, 0_u64);
        for number in 0..self.sectors.as_ref().len() {
            let start = number * SECTOR_BYTES;
            let bytes = self.flash.bytes().get(start..start + SECTOR_BYTES);
            let page = bytes.map_or(Err(NoPage::Damaged), Page::check);
            match page.map(|page| page.header) {
                Ok(header) if usize::from(header.key.slot) < self.sectors.as_ref().len() => {
                    known += 1;
                    sum += u64::from(header.erases);
                    self.sectors.as_mut()[number].erases = header.erases;
                    self.take(number as u16, &header);
                }
                Err(NoPage::Blank) => {}
                Err(NoPage::OtherVersion) => {
                    self.opened.other_version += 1;
                    self.sectors.as_mut()[number].set_foreign(true);
                }
                Ok(_) | Err(NoPage::Damaged) => {
                    self.opened.damaged += 1;
                    self.sectors.as_mut()[number].erases = u32::MAX;
                }
            }
        }
        self.opened.pages = self.pages();
        // The count of a damaged sector is lost: it counts as the mean of the others.
        let mean = (sum / u64::from(known.max(1))) as u32;
        let damaged = self.sectors.as_mut().iter_mut();
        let damaged = damaged.filter(|sector| sector.erases == u32::MAX);
        damaged.for_each(|sector| sector.erases = mean);
    }

    /// Takes the page of a sector, unless there is a newer copy of it.
    fn take(&mut self, sector: u16, header: &PageHeader) {
        self.sequence = self.sequence.max(header.sequence);
        self.drive = self.drive.max(header.last_drive.saturating_add(1));
        let rival = self.view().page_of_slot(header.key.slot);
        if rival.is_none_or(|rival| rival.header.sequence < header.sequence) {
            hold(self.sectors.as_mut(), sector, header);
        }
    }

    /// Returns what the memory held when it was opened.
    pub(super) const fn opened(&self) -> &Opened {
        &self.opened
    }

    /// Returns the flash memory.
    pub(super) const fn flash(&self) -> &F {
        &self.flash
    }

    pub(super) const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Returns the flash memory, and gives up the rest.
    pub(super) fn into_flash(self) -> F {
        self.flash
    }

    /// Returns the roads as they are now.
    pub(super) fn view(&self) -> MemoryView<'_> {
        MemoryView::new(self.flash.bytes(), self.sectors.as_ref())
    }

    /// Returns how often each sector was erased.
    pub(super) fn erases(&self) -> impl Iterator<Item = u32> {
        self.sectors.as_ref().iter().map(|sector| sector.erases)
    }

    /// Returns the page that was written last.
    pub(super) fn newest(&self) -> Option<PageKey> {
        let pages = self.view().pages();
        let newest = pages.max_by_key(|page| page.header.sequence)?;
        Some(newest.header.key)
    }

    fn pages(&self) -> u32 {
        let pages = self.sectors.as_ref().iter();
        pages.filter(|slot| slot.page_sector().is_some()).count() as u32
    }

    /// Returns the key of a new page. If the memory is full, the page that is least worth keeping
    /// makes room, of those that are not needed.
    pub(super) fn new_page(&mut self, is_needed: impl Fn(u16) -> bool) -> Option<PageKey> {
        let sectors = self.sectors.as_mut();
        let free = sectors.iter().filter(|sector| sector.is_free()).count();
        // New pages that are not written yet have no sector. They need one.
        let begun = (0_u16..)
            .zip(sectors.iter())
            .filter(|(slot, of_slot)| of_slot.page_sector().is_none() && is_needed(*slot));
        let mut has_room = free > SPARE + begun.count();
        if !has_room && let Some(foreign) = sectors.iter_mut().find(|sector| sector.is_foreign()) {
            foreign.set_foreign(false);
            has_room = true;
        }
        let empty = (0_u16..)
            .zip(sectors.iter())
            .find(|(slot, of_slot)| of_slot.page_sector().is_none() && !is_needed(*slot));
        let slot = match empty {
            Some((slot, _)) if has_room => slot,
            _ => least_useful(sectors, is_needed)?,
        };
        let generation = sectors[usize::from(slot)].generation;
        Some(PageKey { slot, generation }.next())
    }

    /// Writes a page to the free sector that was erased least often.
    pub(super) fn write(&mut self, page: &PageBuffer) -> Result<(), MemoryError<F::Error>> {
        let free = self.free_sectors().min_by_key(|(_, erases)| *erases);
        match free {
            Some((sector, _)) => self.write_to(sector, page),
            None => Err(MemoryError::Size),
        }
    }

    /// Moves the page that has been longest in its place to a worn sector, if sectors are worn
    /// unevenly. Returns whether it did. `buffer` is overwritten.
    pub(super) fn level(&mut self, buffer: &mut PageBuffer) -> Result<bool, MemoryError<F::Error>> {
        let sound = self.free_sectors().filter(|(_, erases)| *erases < WORN_OUT);
        let Some((worn, most)) = sound.max_by_key(|(_, erases)| *erases) else {
            return Ok(false);
        };
        let sectors = self.sectors.as_ref();
        let held = sectors.iter().filter_map(|slot| {
            let sector = slot.page_sector()?;
            Some((sector, sectors.get(usize::from(sector))?.erases))
        });
        let Some((rested, least)) = held.min_by_key(|(_, erases)| *erases) else {
            return Ok(false);
        };
        if most < least.saturating_add(UNEVEN_ERASES) {
            return Ok(false);
        }
        let start = usize::from(rested) * SECTOR_BYTES;
        let bytes = self.flash.bytes().get(start..start + SECTOR_BYTES);
        let Some(Ok(page)) = bytes.map(Page::check) else {
            return Ok(false);
        };
        buffer.load(&page);
        self.write_to(worn, buffer).map(|()| true)
    }

    fn free_sectors(&self) -> impl Iterator<Item = (u16, u32)> {
        (0_u16..)
            .zip(self.sectors.as_ref())
            .filter(|(_, sector)| sector.is_free())
            .map(|(number, sector)| (number, sector.erases))
    }

    fn write_to(&mut self, sector: u16, page: &PageBuffer) -> Result<(), MemoryError<F::Error>> {
        let place = usize::from(sector);
        let erases = self.sectors.as_ref()[place].erases.saturating_add(1);
        let sequence = self.sequence.saturating_add(1);
        let start = u32::from(sector) * SECTOR_BYTES as u32;
        let flash = &mut self.flash;
        let written = page.sealed(erases, sequence, |header, parts| {
            flash.erase(start, start + SECTOR_BYTES as u32)?;
            write_parts(flash, start, &parts).map(|()| *header)
        });
        self.sectors.as_mut()[place].erases = erases;
        self.sequence = sequence;
        let header = written
            .ok_or(MemoryError::Size)?
            .map_err(MemoryError::Flash)?;
        let start = place * SECTOR_BYTES;
        let bytes = self.flash.bytes().get(start..start + SECTOR_BYTES);
        if bytes.is_some_and(|bytes| is_page(bytes, &header)) {
            hold(self.sectors.as_mut(), sector, &header);
            Ok(())
        } else {
            self.sectors.as_mut()[place].erases = WORN_OUT;
            Err(MemoryError::Worn)
        }
    }
}

/// Returns whether a sector holds the page with this header.
fn is_page(sector: &[u8], header: &PageHeader) -> bool {
    Page::check(sector).is_ok_and(|page| page.header == *header)
}

/// Writes parts one after the other, in chunks.
fn write_parts<F: MappedFlash>(flash: &mut F, start: u32, parts: &[&[u8]]) -> Result<(), F::Error> {
    let mut chunk = [0xff; CHUNK_BYTES];
    let (mut filled, mut at) = (0, start);
    for byte in parts.iter().copied().flatten() {
        chunk[filled] = *byte;
        filled += 1;
        if filled == CHUNK_BYTES {
            flash.write(at, &chunk)?;
            at += CHUNK_BYTES as u32;
            filled = 0;
        }
    }
    if filled > 0 {
        chunk[filled..].fill(0xff);
        flash.write(at, &chunk)?;
    }
    Ok(())
}
