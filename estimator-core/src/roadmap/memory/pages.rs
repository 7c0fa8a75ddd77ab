//! The pages that are being changed, and when they are written.

use super::address::{PageKey, block_number};
use super::flash::MappedFlash;
use super::page::{MOST_BLOCKS, StoredJoin};
use super::page_buffer::PageBuffer;
use super::sectors::Sector;
use super::store::{MemoryError, Store};
use super::work_block::WorkBlock;
use crate::time::{Duration, Instant};

/// Pages that are changed at the same time. A drive changes one, and another around its ends.
const PAGES: usize = 3;
/// Time between two writes.
const WRITE_INTERVAL: Duration = Duration::from_micros(60_000_000);
/// Room that a new block needs, bytes: most need 250.
const BLOCK_ROOM: usize = 500;

/// A place on a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct WayCell {
    pub(super) way: u32,
    pub(super) cell: i32,
}

/// The pages that are being changed.
#[derive(Clone, Debug)]
pub(super) struct Pages {
    buffers: [PageBuffer; PAGES],
    /// The page that new ways go to.
    open: Option<PageKey>,
    written: Option<Instant>,
    pub(super) writes: u32,
    pub(super) failures: u32,
}

impl Pages {
    pub(super) fn new() -> Self {
        Self {
            buffers: Default::default(),
            open: None,
            written: None,
            writes: 0,
            failures: 0,
        }
    }

    /// Returns a page, from flash if need be; `None` if it is no longer there, or if all buffers wait
    /// to be written.
    pub(super) fn page<F, R>(
        &mut self,
        store: &Store<F, R>,
        key: PageKey,
    ) -> Option<&mut PageBuffer>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let index = match self.index(key) {
            Some(index) => index,
            None if self.is_held(key.slot) => return None,
            None => {
                let page = store.view().page(key)?;
                let index = self.clean()?;
                self.buffers[index].load(&page);
                index
            }
        };
        self.buffers.get_mut(index)
    }

    /// Returns the page that a new block goes to; `None` if there is no room.
    pub(super) fn page_with_room<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Option<&mut PageBuffer>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let open = self.open.or_else(|| store.newest());
        let has_room = open
            .and_then(|key| self.page(store, key))
            .is_some_and(|page| page.room() >= BLOCK_ROOM && page.blocks() < MOST_BLOCKS);
        if !has_room {
            let index = self.clean()?;
            self.buffers[index].begin(PageKey::default());
            let key = store.new_page(|slot| self.is_held(slot))?;
            self.buffers[index].begin(key);
            self.open = Some(key);
            return self.buffers.get_mut(index);
        }
        self.open = open;
        self.page(store, open?)
    }

    /// Puts a changed block into its page. Returns false if there is no room.
    pub(super) fn put<F, R>(&mut self, store: &Store<F, R>, block: &WorkBlock, now: Instant) -> bool
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let drive = store.drive;
        let page = self.page(store, PageKey::of(block.way));
        let Some((page, bytes)) = page.zip(block.bytes()) else {
            return false;
        };
        page.touch(drive, now);
        page.put(block.number, &bytes)
    }

    /// Notes that one place can be left for another.
    pub(super) fn join<F, R>(
        &mut self,
        store: &Store<F, R>,
        from: WayCell,
        to: WayCell,
        now: Instant,
    ) where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let drive = store.drive;
        let join = StoredJoin {
            at_way: block_number(from.way),
            at_cell: from.cell,
            to_way: to.way,
            to_cell: to.cell,
        };
        if let Some(page) = self.page(store, PageKey::of(from.way))
            && page.add_join(join)
        {
            page.touch(drive, now);
        }
    }

    /// Returns whether a page may be written now: the last write is a minute ago.
    pub(super) fn is_due(&mut self, now: Instant) -> bool {
        now.since(*self.written.get_or_insert(now)) >= WRITE_INTERVAL
    }

    /// Writes the page whose changes have waited longest. Returns whether there was one.
    pub(super) fn write<F, R>(
        &mut self,
        store: &mut Store<F, R>,
        now: Instant,
    ) -> Result<bool, MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: AsRef<[Sector]> + AsMut<[Sector]>,
    {
        let waiting = self.buffers.iter_mut();
        let waiting = waiting.filter_map(|page| page.changed.map(|since| (since, page)));
        let Some((_, page)) = waiting.min_by_key(|(since, _)| *since) else {
            return Ok(false);
        };
        self.written = Some(now);
        page.changed = None;
        match store.write(page) {
            Ok(()) => self.writes = self.writes.saturating_add(1),
            Err(error) => {
                self.failures = self.failures.saturating_add(1);
                page.changed = Some(now);
                return Err(error);
            }
        }
        Ok(true)
    }

    /// Returns a buffer whose page need not be written.
    pub(super) fn clean_buffer(&mut self) -> Option<&mut PageBuffer> {
        let index = self.clean()?;
        self.buffers.get_mut(index)
    }

    /// Returns whether a page of a slot is in a buffer.
    fn is_held(&self, slot: u16) -> bool {
        let held = |page: &PageBuffer| page.key() != PageKey::default() && page.key().slot == slot;
        self.buffers.iter().any(held)
    }

    fn index(&self, key: PageKey) -> Option<usize> {
        self.buffers.iter().position(|page| page.key() == key)
    }

    /// Returns a buffer whose page need not be written; that of the open page last.
    fn clean(&self) -> Option<usize> {
        let clean = |is_open: bool| {
            self.buffers.iter().position(|page| {
                page.changed.is_none() && (self.open == Some(page.key())) == is_open
            })
        };
        clean(false).or_else(|| clean(true))
    }
}
