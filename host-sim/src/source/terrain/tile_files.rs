//! The files of elevation in a folder, with the place of each.

use super::elevation_grid::{ElevationGrid, GridPlace};
use super::hgt_name::{Corner, corner_of};
use super::{geo_tiff, hgt};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// Folders within the folder: `N59/N59E017.hgt`.
const DEEPEST: usize = 3;
/// Most files that are looked at. The land of the world has 14,000 tiles.
const MOST_FILES: usize = 200_000;

/// A file of elevation.
#[derive(Debug)]
pub(super) struct TileFile {
    path: PathBuf,
    place: GridPlace,
    /// That of an SRTM tile; otherwise, the file is a GeoTIFF.
    corner: Option<Corner>,
}

impl TileFile {
    /// Reads its posts.
    ///
    /// # Errors
    /// Returns an error that names the file, and what was expected.
    pub(super) fn read(&self) -> Result<ElevationGrid> {
        match self.corner {
            Some(corner) => hgt::read(&self.path, corner),
            None => geo_tiff::read(&self.path),
        }
    }
}

/// The files of a folder.
#[derive(Debug, Default)]
pub(super) struct TileFiles {
    files: Vec<TileFile>,
    /// Why the first GeoTIFF cannot be used.
    left_out: Option<Error>,
}

impl TileFiles {
    /// Finds the files in a folder and the folders in it.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be read.
    pub(super) fn of(folder: &Path) -> Result<Self> {
        let mut found = Self::default();
        let files = WalkDir::new(folder).max_depth(DEEPEST).follow_links(true);
        for entry in files.into_iter().take(MOST_FILES) {
            match entry {
                Ok(entry) if entry.file_type().is_file() => found.add(entry.into_path()),
                Ok(_) => {}
                // A folder in it that may not be read.
                Err(error) if error.depth() > 0 => {}
                Err(error) => return Err(Error::io(folder)(error.into())),
            }
        }
        // Of two for one place, the one with the shorter path: that of NASA's name, not packed.
        found
            .files
            .sort_by_key(|file| (file.path.as_os_str().len(), file.path.clone()));
        Ok(found)
    }

    fn add(&mut self, path: PathBuf) {
        let name = path.file_name().unwrap_or_default();
        let name = name.to_string_lossy().to_ascii_uppercase();
        let corner = corner_of(&name);
        let place = match corner {
            Some(corner) => Ok(hgt::extent_of(corner)),
            None if name.ends_with(".TIF") || name.ends_with(".TIFF") => geo_tiff::place_of(&path),
            None => return,
        };
        match place {
            Ok(place) => self.files.push(TileFile {
                path,
                place,
                corner,
            }),
            Err(error) => self.left_out = self.left_out.take().or(Some(error)),
        }
    }

    /// Returns the first file that has this place.
    pub(super) fn at(&self, latitude_deg: f64, longitude_deg: f64) -> Option<&TileFile> {
        let has = |file: &&TileFile| file.place.has(latitude_deg, longitude_deg);
        self.files.iter().find(has)
    }

    /// Returns why the first GeoTIFF of the folder cannot be used.
    pub(super) const fn left_out(&self) -> Option<&Error> {
        self.left_out.as_ref()
    }
}
