//! Runs in Hive's layout: `tile=N47E008/day=2026-11-21/NAME.parquet`. A query engine, or a path
//! with a wildcard, then reads only the tiles and days it needs.

use super::run::RunRows;
use crate::error::{Error, Result};
use chrono::NaiveDate;
use std::path::{Path, PathBuf};

/// Returns the path of a run in a data set: in the tile of its first position. A run is never
/// split, so runs over a road can also be in neighbouring tiles.
///
/// # Errors
/// Returns an error if the run has no position.
pub fn run_path(folder: &Path, rows: &mut dyn RunRows, day: &str, name: &str) -> Result<PathBuf> {
    let mut position = None;
    rows.each(&mut |row| {
        position = position.or(row.latitude_deg.zip(row.longitude_deg));
        Ok(())
    })?;
    let Some((latitude_deg, longitude_deg)) = position else {
        let problem =
            "the run has no position, so it has no tile; expected GNSS positions, or --out";
        return Err(Error::content(folder, problem));
    };
    Ok(folder
        .join(format!("tile={}", tile(latitude_deg, longitude_deg)))
        .join(format!("day={day}"))
        .join(format!("{name}.parquet")))
}

/// Returns the name of the run of a log: the name of the log without its extensions. `drive.csv.gz`
/// gives `drive`, and `drive.1.log` gives `drive.1`.
#[must_use]
pub fn run_name(log: &Path) -> String {
    let name = log.file_name().unwrap_or_default().to_string_lossy();
    let packed = [".gz", ".zst"]
        .iter()
        .find_map(|end| name.strip_suffix(end));
    let name = packed.unwrap_or(&name);
    let ending = name.rfind('.').filter(|&at| at > 0);
    name[..ending.unwrap_or(name.len())].to_owned()
}

/// Returns the tile of a position: the degree of latitude and longitude, named by its south-western
/// corner as elevation data are.
#[must_use]
pub fn tile(latitude_deg: f64, longitude_deg: f64) -> String {
    let (south, west) = (latitude_deg.floor() as i32, longitude_deg.floor() as i32);
    let north_south = if south < 0 { 'S' } else { 'N' };
    let east_west = if west < 0 { 'W' } else { 'E' };
    format!(
        "{north_south}{:02}{east_west}{:03}",
        south.abs(),
        west.abs()
    )
}

/// Checks that a day is YYYY-MM-DD, and one of the calendar.
///
/// # Errors
/// Returns an error that names the expected value.
pub fn check_day(text: &str) -> std::result::Result<String, String> {
    let expected = || format!("{text:?} is not a date; expected YYYY-MM-DD, such as 2026-11-21");
    // The parser also takes days and months of one digit.
    let day = NaiveDate::parse_from_str(text, "%Y-%m-%d").map_err(|_| expected())?;
    if day.to_string() == text {
        Ok(text.to_owned())
    } else {
        Err(expected())
    }
}
