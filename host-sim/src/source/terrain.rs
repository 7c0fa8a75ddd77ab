//! Altitude of the terrain from SRTM tiles.
//!
//! NASA's Shuttle Radar Topography Mission, version 3: one file per square degree, big-endian
//! 16-bit metres above the geoid (EGM96), first row north. A radar measures roofs and treetops, and
//! posts are 90 m (3 arc seconds) or 30 m apart. The data show the trend of a road, but not its
//! details.

use super::terrain_tiles::{Corner, read_unpacked, tiles_in};
use crate::error::{Error, Result};
use srtm_reader::{Coord, Resolution, Tile};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Values of posts without a measurement: in the data set, and in some filled versions.
const VOIDS: [i16; 2] = [i16::MIN, -9999];

/// A folder of SRTM tiles, each read at its first use.
#[derive(Debug)]
pub struct Terrain {
    folder: PathBuf,
    /// The files in it, from the first use on.
    files: Option<BTreeMap<Corner, PathBuf>>,
    tiles: BTreeMap<Corner, Tile>,
}

impl Terrain {
    /// Creates a reader of the tiles in `folder`, named as NASA names them (`N47E008.hgt`), or with a word
    /// behind the place (`N47E008.SRTMGL1.hgt`); also in folders in it, and as .gz or .zip.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            files: None,
            tiles: BTreeMap::new(),
        }
    }

    /// Returns the altitude of the terrain, m above the geoid, by bilinear interpolation between
    /// the four surrounding posts. Returns `None` if one of them is void, or for coordinates
    /// outside the globe.
    ///
    /// # Errors
    /// Returns an error for a tile that is missing or has the wrong size.
    pub fn altitude_m(&mut self, latitude_deg: f64, longitude_deg: f64) -> Result<Option<f64>> {
        let Some(place) = Coord::opt_new(latitude_deg, longitude_deg) else {
            return Ok(None);
        };
        Ok(bilinear(self.tile(place)?, place))
    }

    fn tile(&mut self, place: Coord) -> Result<&Tile> {
        let corner = place.floor();
        if !self.tiles.contains_key(&corner) {
            let files = match self.files.take() {
                Some(files) => files,
                None => tiles_in(&self.folder)?,
            };
            let file = self.files.insert(files).get(&corner);
            let file = file.ok_or_else(|| {
                let name = place.get_filename();
                let problem = format!(
                    "no tile {name}; expected it there, or in a folder there, also as .gz or .zip"
                );
                Error::content(&self.folder, problem)
            })?;
            let tile = read_tile(file, corner)?;
            self.tiles.insert(corner, tile);
        }
        Ok(&self.tiles[&corner])
    }
}

fn read_tile(path: &Path, (latitude, longitude): (i8, i16)) -> Result<Tile> {
    let bytes = read_unpacked(path)?;
    let wrong_size = || {
        Error::content(
            path,
            format!(
                "{} bytes; expected an SRTM tile: 1201 x 1201 or 3601 x 3601 posts of 2 bytes",
                bytes.len()
            ),
        )
    };
    let resolution = [Resolution::SRTM3, Resolution::SRTM1]
        .into_iter()
        .find(|resolution| 2 * resolution.total_len() == bytes.len())
        .ok_or_else(wrong_size)?;
    let posts = Tile::parse_hgt(bytes.as_slice(), resolution).map_err(Error::io(path))?;
    Ok(Tile::new(latitude, longitude, resolution, posts))
}

fn bilinear(tile: &Tile, place: Coord) -> Option<f64> {
    let side = tile.resolution.extent();
    let steps = (side - 1) as f64;
    let south = (f64::from(tile.latitude) + 1.0 - place.lat) * steps;
    let east = (place.lon - f64::from(tile.longitude)) * steps;
    // The last row or column uses the square before it.
    let row = (south as usize).min(side - 2);
    let column = (east as usize).min(side - 2);
    let (down, right) = (south - row as f64, east - column as f64);
    let corners = [
        (row, column, (1.0 - down) * (1.0 - right)),
        (row, column + 1, (1.0 - down) * right),
        (row + 1, column, down * (1.0 - right)),
        (row + 1, column + 1, down * right),
    ];
    corners
        .into_iter()
        .filter(|(_, _, weight)| *weight > 0.0)
        .map(|(row, column, weight)| {
            let post = *tile.data.get(row * side + column)?;
            (!VOIDS.contains(&post)).then(|| weight * f64::from(post))
        })
        .sum()
}
