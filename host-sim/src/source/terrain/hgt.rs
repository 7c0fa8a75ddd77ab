//! Tiles of NASA's Shuttle Radar Topography Mission, version 3.
//!
//! One file per square degree, big-endian 16-bit metres above the geoid (EGM96), first row north.

use super::elevation_grid::{ElevationGrid, GridPlace};
use super::hgt_name::Corner;
use crate::error::{Error, Result};
use crate::files::unpacked;
use std::io::Read;
use std::path::Path;

/// Posts along one side: 3 arc seconds apart, and 1.
const SIDES: [usize; 2] = [1201, 3601];
/// Bytes of the finest tile.
const MOST_BYTES: u64 = 2 * 3601 * 3601;

/// Returns the place of a tile whose size is not known yet.
pub(super) fn extent_of(corner: Corner) -> GridPlace {
    place_of(corner, SIDES[0])
}

fn place_of((latitude, longitude): Corner, side: usize) -> GridPlace {
    let step_deg = 1.0 / (side - 1) as f64;
    GridPlace {
        north_deg: f64::from(latitude) + 1.0,
        west_deg: longitude.into(),
        row_step_deg: step_deg,
        column_step_deg: step_deg,
        rows: side,
        columns: side,
        reach_steps: 0.0,
    }
}

/// Reads a tile.
///
/// # Errors
/// Returns an error that names the file and what was expected.
pub(super) fn read(path: &Path, corner: Corner) -> Result<ElevationGrid> {
    let mut bytes = Vec::new();
    let file = unpacked::open(path, &[".hgt"])?;
    if let Err(error) = file.take(MOST_BYTES + 1).read_to_end(&mut bytes) {
        let problem =
            format!("is damaged ({error}); expected an elevation tile, also as .gz or .zip");
        return Err(Error::content(path, problem));
    }
    let side = SIDES
        .into_iter()
        .find(|side| 2 * side * side == bytes.len());
    let side = side.ok_or_else(|| {
        let problem = format!(
            "{} bytes; expected an SRTM tile: 1201 x 1201 or 3601 x 3601 posts of 2 bytes",
            bytes.len()
        );
        Error::content(path, problem)
    })?;
    let (posts, _) = bytes.as_chunks();
    let posts_m = posts.iter().map(|post| i16::from_be_bytes(*post).into());
    Ok(ElevationGrid::new(
        place_of(corner, side),
        posts_m.collect(),
        None,
    ))
}
