//! A matcher without its map: the memory changes between two cells.

use crate::roadmap::along::Along;
use crate::roadmap::matcher::{MOST_PATHS, Matcher, Search};
use crate::roadmap::packed_map::PackedMap;
use crate::roadmap::path::{ParkedPath, Path};
use crate::roadmap::tile::Tile;
use heapless::Vec;

/// A search of the index without its map.
#[derive(Clone, Copy, Debug)]
struct ParkedSearch {
    tile: Tile,
    slot: u32,
    block: usize,
    corners_left: u8,
    position_e7: (i32, i32),
    course: [f32; 2],
    cell: u32,
}

/// A matcher without its map.
#[derive(Clone, Debug)]
pub(super) struct ParkedMatcher {
    paths: Vec<ParkedPath, MOST_PATHS>,
    along: Along,
    cell: Option<u32>,
    updated_cell: u32,
    recent_e7: [Option<(i32, i32)>; 2],
    course: Option<[f32; 2]>,
    search: Option<ParkedSearch>,
    searched_m: f32,
    blind_m: f32,
}

impl ParkedMatcher {
    /// Creates one that does not know where the vehicle is.
    pub(super) fn new() -> Self {
        Self {
            paths: Vec::new(),
            along: Along::new(),
            cell: None,
            updated_cell: 0,
            recent_e7: [None; 2],
            course: None,
            search: None,
            searched_m: f32::INFINITY,
            blind_m: 0.0,
        }
    }

    /// Leaves the map.
    pub(super) fn park(matcher: &Matcher<'_>) -> Self {
        Self {
            paths: matcher.paths.iter().map(Path::park).collect(),
            along: matcher.along,
            cell: matcher.cell,
            updated_cell: matcher.updated_cell,
            recent_e7: matcher.recent_e7,
            course: matcher.course,
            search: matcher.search.as_ref().map(ParkedSearch::park),
            searched_m: matcher.searched_m,
            blind_m: matcher.blind_m,
        }
    }

    /// Comes back to the map, as it is now.
    pub(super) fn resume<'m>(&self, map: PackedMap<'m>) -> Matcher<'m> {
        let paths = self.paths.iter();
        Matcher {
            map,
            paths: paths.filter_map(|path| Path::resume(&map, path)).collect(),
            along: self.along,
            cell: self.cell,
            updated_cell: self.updated_cell,
            recent_e7: self.recent_e7,
            course: self.course,
            search: self.search.as_ref().map(|search| search.resume(&map)),
            searched_m: self.searched_m,
            blind_m: self.blind_m,
        }
    }
}

impl ParkedSearch {
    fn park(search: &Search<'_>) -> Self {
        Self {
            tile: search.blocks.tile,
            slot: search.blocks.page,
            block: search.blocks.entry,
            corners_left: search.corners_left,
            position_e7: search.position_e7,
            course: search.course,
            cell: search.cell,
        }
    }

    fn resume<'m>(&self, map: &PackedMap<'m>) -> Search<'m> {
        Search {
            blocks: map.blocks_from_page(self.tile, self.slot, self.block),
            corners_left: self.corners_left,
            position_e7: self.position_e7,
            course: self.course,
            cell: self.cell,
        }
    }
}
