//! `roadgrade pack`.

use super::outputs;
use crate::error::{Error, Result, on_one_line};
use crate::map::{self, GRID_M, WayDirection, WayName, WayRows};
use crate::terminal::print::{note, print};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `pack`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade pack map.csv --out map.grade",
    after_long_help = "The vehicle reads the file in place, from flash or from a memory map: ways in their direction \
    of travel with plan view, altitude, grade and its sigma, the joins between them, and an index of \
    places. Each part has a checksum. The grade is within 0.0025 % of that of the map, the position \
    within 0.4 m. The format is in the documentation of estimator_core::roadmap.\n\n\
    A map of a single road is a way with the name of its file, unless it is the only one. Two maps \
    with the same way in the same direction are an error: fuse their runs into one map.\n\n\
    `export MAP.grade --out MAP.csv` reads it back.\n\n\
    Examples:\n  \
    roadgrade pack map.parquet --out map.grade\n  \
    roadgrade pack north.csv south.csv --out both.grade"
)]
pub struct Args {
    /// Maps that `fuse` or `map` wrote, CSV or Parquet, of single roads or of networks.
    #[arg(value_name = "MAP", required = true)]
    maps: Vec<PathBuf>,
    /// File for the packed map.
    #[arg(long, value_name = "MAP.grade")]
    out: PathBuf,
    /// Print what the packed map has as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    outputs::check(args.maps.iter().map(|map| &**map), [&*args.out])?;
    outputs::check_file(&args.out, &["grade"])?;
    let mut ways = Vec::new();
    for path in &args.maps {
        let of_map = map::read_map_ways(path)?;
        ways.extend(named(of_map, path, args.maps.len() > 1));
    }
    let cells: usize = ways.iter().map(|way| way.rows.len()).sum();
    if cells == 0 {
        return Err(Error::content(
            &args.maps[0],
            "has no cells; expected a map with some",
        ));
    }
    let bytes = map::packed_map(&ways).map_err(|problem| Error::content(&args.maps[0], problem))?;
    let (length_km, count) = (cells as f64 * GRID_M * 1e-3, ways.len());
    let bytes_per_km = bytes.len() as f64 / length_km;
    map::stage_packed_map(&args.out, &bytes)?.commit()?;
    if args.json {
        let packed = json!({
            "ways": count, "cells": cells, "length_km": length_km,
            "bytes": bytes.len(), "bytes_per_km": bytes_per_km,
        });
        print(&format!("{packed:#}\n"))
    } else {
        note(format_args!(
            "{}: ways: {count}, {length_km:.1} km, {} bytes, {bytes_per_km:.0} for each km",
            on_one_line(&args.out),
            bytes.len(),
        ));
        Ok(())
    }
}

/// Returns the ways of a map. That of a single road gets the name of its file if there are others.
fn named(ways: Vec<WayRows>, path: &Path, has_others: bool) -> impl Iterator<Item = WayRows> {
    let stem = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    ways.into_iter().map(move |way| WayRows {
        name: way.name.or_else(|| {
            has_others.then(|| WayName {
                way: stem.clone(),
                direction: WayDirection::Forward,
            })
        }),
        rows: way.rows,
    })
}
