//! The page of a single run: that of a map made of it alone.

use crate::error::{Error, Result};
use crate::files::output::Staged;
use crate::files::run::RunRows;
use crate::map::{GRID_M, MapRow, WayRows};
use crate::recorder::RunSummary;
use crate::report::map_page;
use crate::report::on_map::{OnMapCell, on_map_section};
use crate::report::verdict::{verdict_section, with_warnings};
use std::path::Path;

/// Writes the page of a run of this log to a file that appears when it is committed. Cells without a
/// position are not drawn. A drive on a map has a section of it.
///
/// # Errors
/// Returns the error of the file system, or an error for a run without positions.
pub(super) fn stage(
    path: &Path,
    log: &Path,
    run: &mut dyn RunRows,
    summary: &RunSummary,
) -> Result<Staged> {
    let mut rows: Vec<MapRow> = Vec::new();
    let mut on_map: Vec<OnMapCell> = Vec::new();
    let mut cells = 0;
    run.each(&mut |row| {
        cells += 1;
        on_map.extend(OnMapCell::of(row));
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
    let mut page = map_page::page(log, &[WayRows { name: None, rows }]);
    let name = log.file_stem().unwrap_or_default().to_string_lossy();
    let first = verdict_section(&[(&*name, summary)]);
    page.sections
        .insert(0, with_warnings(first, "", &summary.warnings));
    if !on_map.is_empty() {
        page = page.with(on_map_section(&on_map, cells));
    }
    page.stage_alone(path)
}
