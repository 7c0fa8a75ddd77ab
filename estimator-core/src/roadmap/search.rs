//! The search of the index around a position, tile by tile.

use super::packed_map::PackedMap;
use super::tile::{Looked, Tile};
use super::tile_index::TileBlocks;

/// Work of the search in one call: what [`Search::look`] returns adds up to this at most.
pub(super) const WORK_AT_ONCE: u8 = 3;
/// Share of a block that is compared with the position. The search goes on while it has so much.
pub(super) const BLOCK_WORK: u8 = 2;

/// The search of the index around a position.
#[derive(Clone, Debug)]
pub(super) struct Search<'m> {
    pub(super) blocks: TileBlocks<'m>,
    pub(super) around: Around,
}

/// What a search is around.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// Corners of the tiles that are still to be looked at.
    corners_left: u8,
    pub(super) position_e7: (i32, i32),
    pub(super) course: [f32; 2],
    /// Driven cells when the position was taken.
    pub(super) cell: u32,
}

impl<'m> Search<'m> {
    /// Begins around a position.
    pub(super) fn begin(
        map: &PackedMap<'m>,
        position_e7: (i32, i32),
        course: [f32; 2],
        cell: u32,
    ) -> Self {
        Self {
            blocks: map.blocks_in(corner(position_e7, 0)),
            around: Around {
                corners_left: 3,
                position_e7,
                course,
                cell,
            },
        }
    }

    /// Looks for the next block. Returns what it found, and its share of [`WORK_AT_ONCE`]: one for a
    /// block that is left out, [`BLOCK_WORK`] for one that is compared with the position.
    pub(super) fn look(&mut self) -> (Looked, u8) {
        match self.blocks.look() {
            Looked::NotYet => (Looked::NotYet, 1),
            Looked::End if self.next_tile() => (Looked::NotYet, BLOCK_WORK),
            looked => (looked, BLOCK_WORK),
        }
    }

    /// Goes on with the next tile that is not one of those before. Returns false after the last one.
    fn next_tile(&mut self) -> bool {
        let position_e7 = self.around.position_e7;
        let tile = |left: u8| corner(position_e7, 3 - left);
        let next = (0..self.around.corners_left)
            .rev()
            .find(|left| (left + 1..=3).all(|before| tile(before) != tile(*left)));
        let Some(left) = next else {
            return false;
        };
        self.around.corners_left = left;
        self.blocks.look_in(tile(left));
        true
    }
}

/// Returns the tile at one of the four corners around a position.
fn corner(position_e7: (i32, i32), index: u8) -> Tile {
    /// More than the reach in latitude, and in longitude up to 70 degrees of it, 10⁻⁷ degrees.
    const ASIDE_E7: i32 = 8_000;
    let aside = |angle: i32, is_more: bool| {
        angle.saturating_add(if is_more { ASIDE_E7 } else { -ASIDE_E7 })
    };
    Tile::of(
        aside(position_e7.0, index & 1 != 0),
        aside(position_e7.1, index & 2 != 0),
    )
}
