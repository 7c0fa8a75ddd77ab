//! The pages that are being changed, and when they are written.

use super::address::{PageKey, block_number};
use super::block_writer::BlockWriter;
use super::flash::MappedFlash;
use super::page::{MOST_BLOCKS, StoredJoin};
use super::page_buffer::PageBuffer;
use super::sectors::SectorTable;
use super::store::{MemoryError, PageWrite, Store};
use super::work_block::WorkBlock;
use crate::time::{Duration, Instant};
use core::task::{Poll, ready};

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

/// Pages on their way to flash.
#[derive(Clone, Copy, Debug)]
struct Writing {
    /// Since when.
    now: Instant,
    /// The page that is being written, by its buffer; `None` between two.
    page: Option<(usize, PageWrite)>,
}

/// The pages that are being changed.
#[derive(Clone, Debug)]
pub(super) struct Pages {
    buffers: [PageBuffer; PAGES],
    /// A changed block on its way to its page.
    writer: BlockWriter,
    /// Whether its page has room for it now.
    has_room: bool,
    /// The page that new ways go to.
    open: Option<PageKey>,
    written: Option<Instant>,
    writing: Option<Writing>,
    pub(super) writes: u32,
    pub(super) failures: u32,
}

impl Pages {
    pub(super) fn new() -> Self {
        Self {
            buffers: Default::default(),
            writer: BlockWriter::default(),
            has_room: false,
            open: None,
            written: None,
            writing: None,
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
        R: SectorTable,
    {
        let index = self.loaded(store, key)?;
        self.buffers.get_mut(index)
    }

    /// Returns the buffer of a page, which it loads if need be.
    fn loaded<F: MappedFlash, R: SectorTable>(
        &mut self,
        store: &Store<F, R>,
        key: PageKey,
    ) -> Option<usize> {
        if let Some(index) = self.index(key) {
            return Some(index);
        }
        if self.is_held(key.slot) {
            return None;
        }
        let page = store.view().page(key)?;
        let index = self.clean()?;
        self.buffers.get_mut(index)?.load(&page);
        Some(index)
    }

    /// Returns the page that a new block goes to; `None` if there is no room.
    pub(super) fn page_with_room<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Option<&mut PageBuffer>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let open = self.open.or_else(|| store.newest());
        let has_room = open
            .and_then(|key| self.page(store, key))
            .is_some_and(|page| page.room() >= BLOCK_ROOM && page.blocks() < MOST_BLOCKS);
        if !has_room {
            let index = self.clean()?;
            self.buffers.get_mut(index)?.begin(PageKey::default());
            let key = store.new_page(|slot| self.is_held(slot))?;
            let buffer = self.buffers.get_mut(index)?;
            buffer.begin(key);
            self.open = Some(key);
            return Some(buffer);
        }
        self.open = open;
        self.page(store, open?)
    }

    /// Puts a changed block into its page, in shares. Returns false if there is no room.
    pub(super) fn put<F, R>(
        &mut self,
        store: &Store<F, R>,
        block: &WorkBlock,
        now: Instant,
    ) -> Poll<bool>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        let index = self.loaded(store, PageKey::of(block.way));
        let Some(page) = index.and_then(|index| self.buffers.get_mut(index)) else {
            self.writer.begin();
            self.has_room = false;
            return Poll::Ready(false);
        };
        let Some(bytes) = ready!(self.writer.write(block)) else {
            return Poll::Ready(false);
        };
        let has_room = self.has_room;
        self.has_room = !has_room;
        if has_room {
            page.put(block.number, bytes);
            self.writer.begin();
            return Poll::Ready(true);
        }
        page.touch(store.drive, now);
        if page.make_room(block.number, bytes.len()) {
            return Poll::Pending;
        }
        self.has_room = false;
        self.writer.begin();
        Poll::Ready(false)
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
        R: SectorTable,
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

    /// Returns whether pages may be written now: the last write is a minute ago.
    pub(super) fn is_due(&mut self, now: Instant) -> bool {
        now.since(*self.written.get_or_insert(now)) >= WRITE_INTERVAL
    }

    /// Begins to write all pages that wait, mostly one: two around the change from one to the next. If
    /// one of them waited for the next minute, a loss of power would take two minutes of it. Returns
    /// whether there is one.
    pub(super) fn begin_writing(&mut self, now: Instant) -> bool {
        let waits = self.buffers.iter().any(|page| page.changed.is_some());
        self.writing = waits.then_some(Writing { now, page: None });
        waits
    }

    /// Returns whether pages are being written. Until all are, they stay as they are.
    pub(super) const fn is_writing(&self) -> bool {
        self.writing.is_some()
    }

    /// Writes a share of the pages that wait.
    pub(super) fn write_share<F, R>(
        &mut self,
        store: &mut Store<F, R>,
    ) -> Result<(), MemoryError<F::Error>>
    where
        F: MappedFlash,
        R: SectorTable,
    {
        // Taken, so that an error ends it.
        let Some(writing) = self.writing.take() else {
            return Ok(());
        };
        let now = writing.now;
        let (index, mut write) = match writing.page {
            Some(page) => page,
            None => {
                let Some(index) = self.longest_waiting() else {
                    return Ok(());
                };
                self.written = Some(now);
                let begun = self.buffers.get(index).map(|page| store.begin_write(page));
                let write = begun.unwrap_or(Err(MemoryError::Size));
                let write = write.inspect_err(|_| self.count_failure(index, now))?;
                let page = Some((index, write));
                self.writing = Some(Writing { now, page });
                return Ok(());
            }
        };
        let Some(page) = self.buffers.get_mut(index) else {
            return Ok(());
        };
        let is_whole = store.write(&mut write, page);
        let is_whole = is_whole.inspect_err(|_| self.count_failure(index, now))?;
        let page = (!is_whole).then_some((index, write));
        self.writing = Some(Writing { now, page });
        if is_whole {
            self.writes = self.writes.saturating_add(1);
            if let Some(page) = self.buffers.get_mut(index) {
                page.changed = None;
            }
        }
        Ok(())
    }

    /// Returns the buffer whose changes have waited longest.
    fn longest_waiting(&self) -> Option<usize> {
        let waiting = self.buffers.iter().enumerate();
        let waiting = waiting.filter_map(|(index, page)| Some((page.changed?, index)));
        waiting
            .min_by_key(|(since, _)| *since)
            .map(|(_, index)| index)
    }

    /// Counts a failure. The page is tried again a minute later.
    fn count_failure(&mut self, index: usize, now: Instant) {
        self.failures = self.failures.saturating_add(1);
        if let Some(page) = self.buffers.get_mut(index) {
            page.changed = Some(now);
        }
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
