//! The roads of a road memory as a run that `fuse` reads.

use super::packed::block_rows;
use crate::error::{Error, Result};
use crate::files::flash_image;
use crate::files::run::RunRow;
use crate::map::fusion::map_row::MapRow;
use crate::map::geometry::grid::GRID_M;
use estimator_core::roadmap::{MapError, MapWay, PackedMap};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Distance between two roads that do not follow each other, m. Cells so far apart are not joined.
const BETWEEN_ROADS_M: f64 = 1_000.0;
/// Standard deviation of the altitudes, m: that of GNSS. The memory has none.
const ALTITUDE_SIGMA_M: f64 = 3.0;

/// The roads of a memory.
#[derive(Debug)]
pub struct LearnedRun {
    /// Their cells, one road after the other.
    pub rows: Vec<RunRow>,
    /// Number of roads that do not follow each other.
    pub roads: usize,
}

/// Reads the roads of a road memory. Ways that follow each other are one road. The memory knows
/// neither times nor speeds: both are zero.
///
/// # Errors
/// Returns the error of the file system, or says what is wrong with the memory.
pub fn read(path: &Path) -> Result<LearnedRun> {
    let memory = flash_image::open(path, None)?;
    let map = PackedMap::of_memory(memory.view());
    run_of(map).map_err(|problem| Error::content(path, format!("{problem}; expected sound roads")))
}

fn run_of(map: PackedMap<'_>) -> std::result::Result<LearnedRun, MapError> {
    let ways: Vec<MapWay<'_>> = map.ways().collect::<std::result::Result<_, _>>()?;
    let following: BTreeMap<u32, u32> = ways
        .iter()
        .filter_map(|way| Some((way.offset, following(map, way)?)))
        .collect();
    let entered: BTreeSet<u32> = following.values().copied().collect();
    let begins = ways.iter().filter(|way| !entered.contains(&way.offset));
    let mut done = BTreeSet::new();
    let mut run = LearnedRun {
        rows: Vec::new(),
        roads: 0,
    };
    let mut distance_m = 0.0;
    // A ring has no begin: what is left begins anywhere.
    for begin in begins.chain(&ways) {
        let mut next = Some(begin.offset);
        let count = run.rows.len();
        while let Some(way) = next.filter(|way| done.insert(*way)) {
            append(map, &map.way(way)?, &mut distance_m, &mut run.rows)?;
            next = following.get(&way).copied();
        }
        if run.rows.len() > count {
            run.roads += 1;
            distance_m += BETWEEN_ROADS_M;
        }
    }
    Ok(run)
}

/// Returns the way that goes on where this one ends.
fn following(map: PackedMap<'_>, way: &MapWay<'_>) -> Option<u32> {
    map.joins_from(way, way.last_cell as f32)
        .filter_map(std::result::Result::ok)
        .find(|join| {
            map.way(join.to_way)
                .is_ok_and(|entered| entered.first_cell == join.to_cell)
        })
        .map(|join| join.to_way)
}

fn append(
    map: PackedMap<'_>,
    way: &MapWay<'_>,
    distance_m: &mut f64,
    rows: &mut Vec<RunRow>,
) -> std::result::Result<(), MapError> {
    for block in map.blocks(way) {
        for row in block_rows(&block?)? {
            *distance_m += GRID_M;
            rows.push(run_row(*distance_m, &row));
        }
    }
    Ok(())
}

fn run_row(distance_m: f64, row: &MapRow) -> RunRow {
    let (grade, sigma) = (row.grade_percent, row.grade_sigma_percent);
    RunRow {
        time_s: 0.0,
        distance_m,
        latitude_deg: Some(row.latitude_deg),
        longitude_deg: Some(row.longitude_deg),
        altitude_m: row.altitude_m,
        altitude_sigma_m: row.altitude_m.map(|_| ALTITUDE_SIGMA_M),
        grade_percent: grade,
        grade_sigma_percent: sigma,
        lagged_grade_percent: grade,
        lagged_grade_sigma_percent: sigma,
        live_grade_percent: grade,
        live_grade_sigma_percent: sigma,
        speed_mps: 0.0,
        bias_percent: 0.0,
        scale: 1.0,
        valid: 1,
        mass_kg: None,
        mass_sigma_kg: None,
        consistent: 1,
        lagged_consistent: 1,
        live_consistent: 1,
        map_grade_percent: None,
        map_grade_sigma_percent: None,
    }
}
