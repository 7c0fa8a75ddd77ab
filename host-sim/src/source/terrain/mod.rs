//! Altitude of the terrain from a folder of elevation tiles.
//!
//! A radar measures roofs and treetops, and posts are 90 m (3 arc seconds) or 30 m apart. The data
//! show the trend of a road, but not its details.

mod elevation_grid;
mod geo_tiff;
mod hgt;
mod hgt_name;
mod tile_files;

use crate::error::{Error, Result};
use crate::files::data_set::tile;
use elevation_grid::ElevationGrid;
use std::path::{Path, PathBuf};
use tile_files::TileFiles;

/// Grids in memory: each takes up to 52 MB, and a road goes along the edge of four at most.
const MOST_GRIDS: usize = 8;

/// A folder of elevation tiles, each read at its first use.
#[derive(Debug)]
pub struct Terrain {
    folder: PathBuf,
    /// The files in it, from the first use on.
    files: Option<TileFiles>,
    grids: Vec<ElevationGrid>,
}

impl Terrain {
    /// Creates a reader of the tiles in `folder` and in folders in it: SRTM tiles, named as NASA names
    /// them (`N47E008.hgt`), or with a word behind the place (`N47E008.SRTMGL1.hgt`), also as .gz or
    /// .zip; and GeoTIFF in latitude and longitude.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            files: None,
            grids: Vec::new(),
        }
    }

    /// Returns the altitude of the terrain, m above the geoid, by bilinear interpolation between
    /// the four surrounding posts. Returns `None` if one of them is void, or for coordinates
    /// outside the globe.
    ///
    /// # Errors
    /// Returns an error for a tile that is missing or cannot be read.
    pub fn altitude_m(&mut self, latitude_deg: f64, longitude_deg: f64) -> Result<Option<f64>> {
        if !(latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0) {
            return Ok(None);
        }
        let grid = self.grid(latitude_deg, longitude_deg)?;
        Ok(grid.altitude_m(latitude_deg, longitude_deg))
    }

    fn grid(&mut self, latitude_deg: f64, longitude_deg: f64) -> Result<&ElevationGrid> {
        let has = |grid: &ElevationGrid| grid.has(latitude_deg, longitude_deg);
        let at = match self.grids.iter().position(has) {
            Some(at) => at,
            None => {
                let files = match self.files.take() {
                    Some(files) => files,
                    None => TileFiles::of(&self.folder)?,
                };
                let files = self.files.insert(files);
                let Some(file) = files.at(latitude_deg, longitude_deg) else {
                    let name = format!("{}.hgt", tile(latitude_deg, longitude_deg));
                    return Err(missing(&self.folder, &name, files.left_out()));
                };
                let grid = file.read()?;
                if self.grids.len() == MOST_GRIDS {
                    self.grids.clear();
                }
                self.grids.push(grid);
                self.grids.len() - 1
            }
        };
        Ok(&self.grids[at])
    }
}

fn missing(folder: &Path, name: &str, left_out: Option<&Error>) -> Error {
    let mut problem = format!(
        "no tile {name}, and no GeoTIFF of that place; expected it there, or in a folder there, the \
         tile also as .gz or .zip"
    );
    if let Some(error) = left_out {
        problem = format!("{problem}; not used: {error}");
    }
    Error::content(folder, problem)
}
