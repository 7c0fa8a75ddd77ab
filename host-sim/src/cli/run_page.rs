//! The page of a single run: that of a map made of it alone.

use crate::error::{Error, Result};
use crate::files::output::Staged;
use crate::files::run::RunRows;
use crate::map::{GRID_M, MapRow, WayRows};
use crate::report::map_page;
use std::path::Path;

/// Writes the page of a run of this log to a file that appears when it is committed. Cells without a
/// position are not drawn.
///
/// # Errors
/// Returns the error of the file system, or an error for a run without positions.
pub(super) fn stage(path: &Path, log: &Path, run: &mut dyn RunRows) -> Result<Staged> {
    let mut rows: Vec<MapRow> = Vec::new();
    run.each(&mut |row| {
        let position = row.latitude_deg.zip(row.longitude_deg);
        rows.extend(position.map(|(latitude_deg, longitude_deg)| MapRow {
            distance_m: row.distance_m,
            latitude_deg,
            longitude_deg,
            altitude_m: row.altitude_m,
            grade_percent: row.grade_percent,
            grade_sigma_percent: row.grade_sigma_percent,
            runs: 1,
        }));
        Ok(())
    })?;
    if rows.is_empty() {
        let problem = format!(
            "the run of {} has no position in any cell of {GRID_M} m, so there is nothing to draw",
            log.display()
        );
        return Err(Error::content(path, problem));
    }
    map_page::page(log, &[WayRows { name: None, rows }]).stage_alone(path)
}
