//! Terrain as a reference that shares nothing with the vehicle.

use super::drive::LoggedDrive;
use super::judgement::ReferenceGrades;
use crate::error::Result;
use crate::numeric::series::linear;
use crate::source::terrain::Terrain;

/// Distance over which the terrain's altitudes become a grade, m: about two posts of a tile.
const BASE_M: f64 = 200.0;

/// Returns the terrain's grade along each drive, where it has positions.
///
/// # Errors
/// Returns an error for a tile that is missing or cannot be read.
pub fn references_by_terrain(
    drives: &[LoggedDrive],
    terrain: &mut Terrain,
) -> Result<Vec<ReferenceGrades>> {
    drives.iter().map(|drive| along(drive, terrain)).collect()
}

fn along(drive: &LoggedDrive, terrain: &mut Terrain) -> Result<ReferenceGrades> {
    let mut altitudes = Vec::new();
    for row in &drive.run.rows {
        let (Some(latitude_deg), Some(longitude_deg)) = (row.latitude_deg, row.longitude_deg)
        else {
            continue;
        };
        if let Some(altitude_m) = terrain.altitude_m(latitude_deg, longitude_deg)? {
            altitudes.push((row.distance_m, altitude_m));
        }
    }
    let grade = |at_m: f64| {
        let [behind_m, ahead_m] = [-0.5, 0.5].map(|side| linear(&altitudes, at_m + side * BASE_M));
        Some((at_m, 100.0 * (ahead_m? - behind_m?) / BASE_M))
    };
    Ok(altitudes
        .iter()
        .filter_map(|&(at_m, _)| grade(at_m))
        .collect())
}
