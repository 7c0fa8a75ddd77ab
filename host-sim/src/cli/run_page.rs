//! The page of a single run: that of a map made of it alone.

use crate::error::Result;
use crate::files::output::Staged;
use crate::files::run::RunRows;
use crate::map::{MapRow, WayRows};
use crate::recorder::RunSummary;
use crate::report::map_page;
use crate::report::on_map::{OnMapCell, on_map_section};
use crate::report::plot::shaded_ranges;
use crate::report::verdict::{suspect_section, with_verdict, with_warnings};
use std::path::Path;

/// Writes the page of a run of this log to a file that appears when it is committed. Cells without a
/// position are not on the plan. A drive on a map has a section of it.
///
/// # Errors
/// Returns the error of the file system.
pub(super) fn stage(
    path: &Path,
    log: &Path,
    run: &mut dyn RunRows,
    summary: &RunSummary,
) -> Result<Staged> {
    let mut rows: Vec<MapRow> = Vec::new();
    let mut on_map: Vec<OnMapCell> = Vec::new();
    let mut suspect = Vec::new();
    run.each(&mut |row| {
        on_map.extend(OnMapCell::of(row));
        suspect.push((row.distance_m * 1e-3, row.consistent == 0));
        rows.push(MapRow {
            distance_m: row.distance_m,
            latitude_deg: row.latitude_deg.unwrap_or(f64::NAN),
            longitude_deg: row.longitude_deg.unwrap_or(f64::NAN),
            altitude_m: row.altitude_m,
            grade_percent: row.grade_percent,
            grade_sigma_percent: row.grade_sigma_percent,
            runs: 1,
        });
        Ok(())
    })?;
    let cells = rows.len();
    let suspect = shaded_ranges(suspect);
    let ways = [WayRows { name: None, rows }];
    let page = map_page::page(log, &ways, |_| suspect.clone());
    let name = log.file_stem().unwrap_or_default().to_string_lossy();
    let runs = [(&*name, summary)];
    let wrong = with_warnings(suspect_section(&runs), "", &summary.warnings);
    let mut page = with_verdict(page, &runs, wrong);
    if !on_map.is_empty() {
        page = page.with(on_map_section(&on_map, cells));
    }
    page.stage_alone(path)
}
