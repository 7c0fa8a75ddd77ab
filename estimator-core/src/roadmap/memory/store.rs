//! Pages in flash. A page that changes is written to a free sector. Its older copy stays until then
//! and counts if the power is lost.

use super::address::PageKey;
use super::flash::{
    CHUNK_BYTES, FEWEST_SECTORS, MOST_SECTORS, MappedFlash, SECTOR_BYTES, sector_bytes,
};
use super::page::{NoPage, Page, PageHeader};
use super::page_buffer::{PageBuffer, overlay};
use super::sectors::{Sector, SectorTable, hold, least_useful};
use super::view::MemoryView;
use crate::roadmap::record::checksum_after;
use core::fmt;

/// Sectors that stay free.
const SPARE: usize = 2;
/// Difference of erase counts from which a page moves to a worn sector.
const UNEVEN_ERASES: u32 = 16;
/// Chunks of a page that are written in one call.
const CHUNKS_AT_ONCE: usize = 3;
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
    changes: u32,
    /// The page that was written last.
    newest: Option<PageKey>,
    /// Number of this drive.
    pub(super) drive: u32,
    opened: Opened,
}

impl<F: MappedFlash, R: SectorTable> Store<F, R> {
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
            changes: 0,
            newest: None,
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
            let bytes = sector_bytes(self.flash.bytes(), number as u16);
            let page = bytes.map_or(Err(NoPage::Damaged), Page::check);
            let page = page.map(|page| page.header);
            let count = self.sectors.as_ref().len();
            let Some(sector) = self.sectors.as_mut().get_mut(number) else {
                return;
            };
            match page {
                Ok(header) if usize::from(header.key.slot) < count => {
                    known += 1;
                    sum += u64::from(header.erases);
                    sector.erases = header.erases;
                    self.take(number as u16, &header);
                }
                Err(NoPage::Blank) => {}
                Err(NoPage::OtherVersion) => {
                    self.opened.other_version += 1;
                    sector.set_foreign(true);
                }
                Ok(_) | Err(NoPage::Damaged) => {
                    self.opened.damaged += 1;
                    sector.erases = u32::MAX;
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
        if header.sequence >= self.sequence {
            self.sequence = header.sequence;
            self.newest = Some(header.key);
        }
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

    /// Returns how often the roads have changed: with each page that counts from then on.
    pub(super) const fn changes(&self) -> u32 {
        self.changes
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
    pub(super) const fn newest(&self) -> Option<PageKey> {
        self.newest
    }

    fn pages(&self) -> u32 {
        let pages = self.sectors.as_ref().iter();
        pages.filter(|slot| slot.page_sector().is_some()).count() as u32
    }

    /// Returns the key of a new page. If the memory is full, the page that is least worth keeping
    /// makes room, of those that are not needed.
    pub(super) fn new_page(&mut self, is_needed: impl Fn(u16) -> bool) -> Option<PageKey> {
        let sectors = self.sectors.as_mut();
        let mut free = sectors.iter().filter(|sector| sector.is_free()).count();
        // New pages that are not written yet have no sector. They need one.
        let begun = (0_u16..)
            .zip(sectors.iter())
            .filter(|(slot, of_slot)| of_slot.page_sector().is_none() && is_needed(*slot));
        let wanted = SPARE + begun.count() + 1;
        let foreign = sectors.iter_mut().filter(|sector| sector.is_foreign());
        for sector in foreign.take(wanted.saturating_sub(free)) {
            sector.set_foreign(false);
            free += 1;
        }
        let has_room = free >= wanted;
        let empty = (0_u16..)
            .zip(sectors.iter())
            .find(|(slot, of_slot)| of_slot.page_sector().is_none() && !is_needed(*slot));
        let slot = match empty {
            Some((slot, _)) if has_room => slot,
            _ => least_useful(sectors, is_needed)?,
        };
        let generation = sectors.get(usize::from(slot))?.generation;
        Some(PageKey { slot, generation }.next())
    }

    /// Begins to write a page to the free sector that was erased least often: erases it.
    pub(super) fn begin_write(
        &mut self,
        page: &PageBuffer,
    ) -> Result<PageWrite, MemoryError<F::Error>> {
        let free = self.free_sectors().min_by_key(|(_, erases)| *erases);
        let (sector, _) = free.ok_or(MemoryError::Size)?;
        self.begin_write_to(sector, page)
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
        let bytes = sector_bytes(self.flash.bytes(), rested);
        let Some(Ok(page)) = bytes.map(Page::check) else {
            return Ok(false);
        };
        buffer.load(&page);
        let mut write = self.begin_write_to(worn, buffer)?;
        while !self.write(&mut write, buffer)? {}
        Ok(true)
    }

    fn free_sectors(&self) -> impl Iterator<Item = (u16, u32)> {
        (0_u16..)
            .zip(self.sectors.as_ref())
            .filter(|(_, sector)| sector.is_free())
            .map(|(number, sector)| (number, sector.erases))
    }

    fn begin_write_to(
        &mut self,
        sector: u16,
        page: &PageBuffer,
    ) -> Result<PageWrite, MemoryError<F::Error>> {
        let of_sector = self.sectors.as_mut().get_mut(usize::from(sector));
        let of_sector = of_sector.ok_or(MemoryError::Size)?;
        of_sector.erases = of_sector.erases.saturating_add(1);
        self.sequence = self.sequence.saturating_add(1);
        let header = page.header(of_sector.erases, self.sequence);
        let write = PageWrite {
            sector,
            header: header.ok_or(MemoryError::Size)?,
            written: 0,
            sum: 0,
        };
        let start = write.start();
        let erased = self.flash.erase(start, start + SECTOR_BYTES as u32);
        erased.map(|()| write).map_err(MemoryError::Flash)
    }

    /// Writes a share of a page, which stays as it is until the last one. Returns whether that was it:
    /// then the page counts.
    pub(super) fn write(
        &mut self,
        write: &mut PageWrite,
        page: &PageBuffer,
    ) -> Result<bool, MemoryError<F::Error>> {
        for _ in 0..CHUNKS_AT_ONCE {
            let at = write.start() + write.written as u32;
            let mut chunk = Chunk([0xff; CHUNK_BYTES]);
            let is_last = write.fill(&mut chunk.0, page).ok_or(MemoryError::Size)?;
            self.flash.write(at, &chunk.0).map_err(MemoryError::Flash)?;
            let there = self.flash.bytes().get(at as usize..);
            if !there.is_some_and(|there| chunk.is_at_begin_of(there)) {
                self.wear_out(write.sector);
                return Err(MemoryError::Worn);
            }
            if is_last {
                hold(self.sectors.as_mut(), write.sector, &write.header);
                self.newest = Some(write.header.key);
                self.changes = self.changes.wrapping_add(1);
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn wear_out(&mut self, sector: u16) {
        if let Some(sector) = self.sectors.as_mut().get_mut(usize::from(sector)) {
            sector.erases = WORN_OUT;
        }
    }
}

/// A part of a page. Aligned words are copied several times as fast.
#[repr(align(4))]
struct Chunk([u8; CHUNK_BYTES]);

impl Chunk {
    /// Returns whether bytes begin with these, compared word by word.
    fn is_at_begin_of(&self, bytes: &[u8]) -> bool {
        let (own, _) = self.0.as_chunks::<4>();
        let (there, _) = bytes.as_chunks::<4>();
        let word = |bytes: &[u8; 4]| u32::from_ne_bytes(*bytes);
        there.len() >= own.len() && own.iter().zip(there).all(|(a, b)| word(a) == word(b))
    }
}

/// A page on its way to a sector.
#[derive(Clone, Copy, Debug)]
pub(super) struct PageWrite {
    sector: u16,
    header: PageHeader,
    /// Bytes that are written, and the checksum of their content.
    written: usize,
    sum: u32,
}

impl PageWrite {
    fn start(&self) -> u32 {
        u32::from(self.sector) * SECTOR_BYTES as u32
    }

    /// Fills the next chunk, which is of ones, with what is written there. The checksum follows the
    /// content. Returns whether it is the last one.
    fn fill(&mut self, chunk: &mut [u8; CHUNK_BYTES], page: &PageBuffer) -> Option<bool> {
        let (at, length) = (self.written, usize::from(self.header.length));
        page.copy_to(chunk, at, &self.header)?;
        let content = length.saturating_sub(at).min(CHUNK_BYTES);
        self.sum = checksum_after(self.sum, chunk.get(..content)?);
        self.written += CHUNK_BYTES;
        if self.written >= length {
            overlay(chunk, at, &self.sum.to_le_bytes(), length);
        }
        Some(self.written >= length + size_of::<u32>())
    }
}
