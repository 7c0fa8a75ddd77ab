//! The altitudes of a map as elevation tiles, the form in which routers take them.
//!
//! A tile is a square degree of 3601 x 3601 posts, 1 arc second apart, each a whole number of
//! metres in 16 bits, the most significant byte first, the first row in the north
//! (<https://wiki.openstreetmap.org/wiki/SRTM>). Valhalla reads `DIR/N47/N47E008.hgt`
//! (`additional_data.elevation`, <https://valhalla.github.io/valhalla/elevation/>), GraphHopper
//! `DIR/N47E008.hgt` with the provider `sonny`, DIR being `graph.elevation.cache_dir`
//! (<https://github.com/graphhopper/graphhopper/blob/master/docs/core/elevation.md>).

use crate::error::{Error, Result};
use crate::files::output::{Staged, stage as stage_file};
use crate::map::fusion::map_row::WayRows;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Posts along one side.
const SIDE: usize = 3601;
/// A post without an altitude.
const VOID: i16 = i16::MIN;
/// Roads at one post whose altitudes differ by more than this, m, are at different levels: a bridge
/// over a road, and more than a steep road alone has around a post.
const LEVELS_M: f64 = 6.0;
/// The last posts of a tile are the first of the next, whose file may be missing.
const INSIDE: f64 = 1.0 - 1e-9;
/// Most tiles: each takes 26 MB.
const MOST_TILES: usize = 100;

/// The posts of a square degree, south-western corner, that roads pass.
type Posts = BTreeMap<(usize, usize), Post>;

/// What roads tell of a post.
#[derive(Clone, Copy, Default)]
struct Post {
    weight: f64,
    sum_m: f64,
    least_m: f64,
    most_m: f64,
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileCount {
    /// Tiles.
    pub tiles: usize,
    /// Posts with the altitude of a road.
    pub posts: usize,
    /// Posts that roads of different levels share: a tile has one altitude at each.
    pub shared: usize,
}

/// Writes the tiles through which the map goes into a folder, all or none. `ground` returns the
/// altitude of the terrain, m, for posts beside the roads; `None` leaves them void.
///
/// # Errors
/// Returns an error if no cell has an altitude, for too many tiles, the error of the file system, or
/// that of `ground`.
pub fn write(
    folder: &Path,
    ways: &[WayRows],
    mut ground: impl FnMut(f64, f64) -> Result<Option<f64>>,
) -> Result<TileCount> {
    let tiles = posts(ways);
    let wrong = |problem: String| Err(Error::content(folder, problem));
    if tiles.is_empty() {
        return wrong("no cell of the map has an altitude; expected some".to_owned());
    }
    if tiles.len() > MOST_TILES {
        return wrong(format!(
            "the map is on {} square degrees; expected at most {MOST_TILES}",
            tiles.len()
        ));
    }
    let mut count = TileCount::default();
    let mut staged = Vec::new();
    for (corner, posts) in &tiles {
        count.tiles += 1;
        count.posts += posts.len();
        count.shared += posts
            .values()
            .filter(|p| p.most_m - p.least_m > LEVELS_M)
            .count();
        staged.push(stage_tile(folder, *corner, posts, &mut ground)?);
    }
    staged.into_iter().try_for_each(Staged::commit)?;
    Ok(count)
}

/// Returns the posts around all cells: the altitude between four posts is read from them.
fn posts(ways: &[WayRows]) -> BTreeMap<(i32, i32), Posts> {
    let mut tiles: BTreeMap<(i32, i32), Posts> = BTreeMap::new();
    let steps = (SIDE - 1) as f64;
    for row in ways.iter().flat_map(|way| &way.rows) {
        let Some(altitude_m) = row.altitude_m else {
            continue;
        };
        let (south, west) = (row.latitude_deg.floor(), row.longitude_deg.floor());
        let (up, right) = (
            (row.latitude_deg - south) * steps,
            (row.longitude_deg - west) * steps,
        );
        let posts = tiles.entry((south as i32, west as i32)).or_default();
        let (low, left) = ((up as usize).min(SIDE - 2), (right as usize).min(SIDE - 2));
        let (up, right) = (up - low as f64, right - left as f64);
        for (above, beside, weight) in [
            (0, 0, (1.0 - up) * (1.0 - right)),
            (0, 1, (1.0 - up) * right),
            (1, 0, up * (1.0 - right)),
            (1, 1, up * right),
        ] {
            let post = posts.entry((low + above, left + beside)).or_default();
            post.add(altitude_m, weight + 1e-3);
        }
    }
    tiles
}

impl Post {
    fn add(&mut self, altitude_m: f64, weight: f64) {
        if self.weight == 0.0 {
            (self.least_m, self.most_m) = (altitude_m, altitude_m);
        }
        self.weight += weight;
        self.sum_m += weight * altitude_m;
        self.least_m = self.least_m.min(altitude_m);
        self.most_m = self.most_m.max(altitude_m);
    }
}

fn stage_tile(
    folder: &Path,
    (south, west): (i32, i32),
    posts: &Posts,
    ground: &mut impl FnMut(f64, f64) -> Result<Option<f64>>,
) -> Result<Staged> {
    let steps = (SIDE - 1) as f64;
    let mut bytes = Vec::with_capacity(2 * SIDE * SIDE);
    for up in (0..SIDE).rev() {
        for right in 0..SIDE {
            let altitude_m = match posts.get(&(up, right)) {
                Some(post) => Some(post.sum_m / post.weight),
                None => ground(
                    f64::from(south) + (up as f64 / steps).min(INSIDE),
                    f64::from(west) + (right as f64 / steps).min(INSIDE),
                )?,
            };
            // Far below the range of the type: altitudes end at 9 km.
            let post = altitude_m.map_or(VOID, |altitude_m| altitude_m.round() as i16);
            bytes.extend(post.to_be_bytes());
        }
    }
    let (ns, ew) = (
        if south < 0 { 'S' } else { 'N' },
        if west < 0 { 'W' } else { 'E' },
    );
    let band = format!("{ns}{:02}", south.abs());
    let folder = folder.join(&band);
    fs::create_dir_all(&folder).map_err(Error::io(&folder))?;
    let path = folder.join(format!("{band}{ew}{:03}.hgt", west.abs()));
    stage_file(&path, |out| out.write_all(&bytes))
}
