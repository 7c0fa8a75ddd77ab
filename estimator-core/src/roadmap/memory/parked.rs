//! A matcher without its map: the memory changes between two cells.

use crate::cell::CellEnd;
use crate::roadmap::matcher::{MOST_PATHS, Matcher, MatcherState};
use crate::roadmap::packed_map::PackedMap;
use crate::roadmap::path::{ParkedPath, Path};
use crate::roadmap::search::{Around, Search};
use crate::roadmap::tile::Tile;
use heapless::Vec;

/// A search of the index without its map.
#[derive(Clone, Copy, Debug)]
struct ParkedSearch {
    tile: Tile,
    slot: u32,
    block: usize,
    around: Around,
}

/// A matcher without its map.
#[derive(Clone, Debug)]
pub(super) struct ParkedMatcher {
    paths: Vec<ParkedPath, MOST_PATHS>,
    search: Option<ParkedSearch>,
    state: MatcherState,
    /// How often the map had changed when it was left.
    changes: u32,
}

impl ParkedMatcher {
    /// Creates one that does not know where the vehicle is.
    pub(super) fn new() -> Self {
        Self {
            paths: Vec::new(),
            search: None,
            state: MatcherState::new(),
            changes: 0,
        }
    }

    /// Returns whether a cell lies before the newest: another estimator has begun the next drive.
    pub(super) fn is_next_drive(&self, end: &CellEnd) -> bool {
        self.state.is_next_drive(end)
    }

    /// Forgets where the vehicle is.
    pub(super) fn forget(&mut self) {
        self.paths.clear();
        self.search = None;
        self.state = MatcherState::new();
    }

    /// Leaves the map, which has changed so often.
    pub(super) fn park(&mut self, matcher: &Matcher<'_>, changes: u32) {
        self.changes = changes;
        self.paths.clear();
        for path in &matcher.paths {
            let _ = self.paths.push(path.park());
        }
        self.search = matcher.search.as_ref().map(ParkedSearch::park);
        self.state = matcher.state;
    }

    /// Comes back to the map of a new matcher, as it is now. In place: a matcher is long.
    pub(super) fn resume(&self, matcher: &mut Matcher<'_>, changes: u32) {
        let map = *matcher.map();
        let has_changed = changes != self.changes;
        for parked in &self.paths {
            if let Some(path) = Path::resume(&map, parked, has_changed) {
                let _ = matcher.paths.push(path);
            }
        }
        matcher.search = self.search.as_ref().map(|search| search.resume(&map));
        matcher.has_read = has_changed;
        matcher.state = self.state;
    }
}

impl ParkedSearch {
    fn park(search: &Search<'_>) -> Self {
        Self {
            tile: search.blocks.tile,
            slot: search.blocks.page,
            block: search.blocks.entry,
            around: search.around,
        }
    }

    fn resume<'m>(&self, map: &PackedMap<'m>) -> Search<'m> {
        Search {
            blocks: map.blocks_from_page(self.tile, self.slot, self.block),
            around: self.around,
        }
    }
}
