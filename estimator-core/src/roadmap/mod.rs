//! The map on the vehicle: `MAP.grade`, read in place from a byte slice.
//!
//! [`PackedMap`] reads a map from flash, a file or a memory map without copying it. `roadgrade pack`
//! writes it. `docs/map-grade.md` specifies the format; [`format`] has its constants.
//!
//! A way is a line in one direction of travel. Its cells have a number: the distance along the way
//! over 2.5 m. A [`Block`] is up to 128 cells of one way without a gap. Each record ends with a
//! checksum, which is checked when the record is read. A map of a country opens as fast as one of a
//! road, and damage in one place leaves the others usable.
//!
//! ```
//! use estimator_core::roadmap::{MapError, PackedMap, Tile};
//!
//! fn grades_near(map: &[u8], latitude_e7: i32, longitude_e7: i32) -> Result<(), MapError> {
//!     let map = PackedMap::open(map)?;
//!     for block in map.blocks_in(Tile::of(latitude_e7, longitude_e7)) {
//!         let block = map.block(block?)?;
//!         for cell in block.cells()? {
//!             let _ = (block.way, cell.cell, cell.grade_percent, cell.grade_sigma_percent);
//!         }
//!     }
//!     Ok(())
//! }
//! # assert_eq!(grades_near(b"other", 0, 0), Err(MapError::Magic));
//! ```

mod alignment;
mod along;
mod block;
mod block_cells;
mod combination;
mod horizon;
mod horizon_parts;
mod join;
mod joins;
mod map_error;
mod map_judge;
mod map_limits;
mod map_live;
mod matcher;
pub mod memory;
mod packed_map;
mod path;
mod plane;
mod profile;
mod record;
mod search;
mod stored_roads;
mod tile;
mod tile_index;

pub use block::{Block, MapPoint, Points};
pub use block_cells::{Cells, MapCell};
pub use combination::{RoadGrade, combined_with_roads};
pub use horizon::{Branch, Horizon, HorizonPoint, MOST_BRANCHES};
pub use horizon_parts::{
    HorizonPart, HorizonParts, NextGrade, NumberedPart, PART_GRADES, PART_LENGTH_M, PART_STEP_M,
};
pub use join::Join;
pub use joins::Joins;
pub use map_error::MapError;
pub use map_judge::MapCounters;
pub use map_live::MapLive;
pub use matcher::{MapMatch, MapPlace, Matcher};
pub use packed_map::{Blocks, MapWay, PackedMap, WayDirection, Ways};
pub use tile::{Tile, TileBounds};
pub use tile_index::TileBlocks;

/// Constants of the format, for those who write it: `docs/map-grade.md`.
pub mod format {
    pub use super::block::{HEADER as BLOCK_HEADER, MOST_CELLS};
    pub use super::block_cells::{
        ALTITUDE_CELLS, ALTITUDE_UNITS_PER_CM, GRADE_UNITS_PER_PERCENT, SIGMA_CELLS,
        SIGMA_CODES_PER_OCTAVE, SIGMA_UNIT_PERCENT,
    };
    pub use super::joins::JOIN;
    pub use super::packed_map::{HEADER, MAGIC, VERSION, WAY_HEADER};
    pub use super::record::checksum;
    pub use super::tile_index::{INDEX_ENTRIES, INDEX_PAGE};
}
