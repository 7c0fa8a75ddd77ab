//! `roadgrade fuse`.

use crate::error::{Error, Result};
use crate::map::{self, Coverage, GradeMap, RoadLine, RoadPoint, RoadRow};
use crate::run_file::{self, RunRow};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Runs in memory at once.
const BATCH: usize = 8;

/// Arguments of `fuse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each run is placed on the road by position and course; the odometer only carries from one \
    position to the next. Where a run is off the road, crosses it or drives it the other way, it \
    adds nothing. Smoothed grades and altitudes are then weighted by the inverse of their \
    variances, every 2.5 m. Cells that no run covers have no row in the map.\n\n\
    Example: roadgrade fuse --out map.csv monday.csv tuesday.csv"
)]
pub struct Args {
    /// Where the map goes: distance_m, latitude_deg, longitude_deg, altitude_m, grade_percent,
    /// grade_sigma_percent, runs.
    #[arg(long, value_name = "MAP.csv")]
    out: PathBuf,
    /// The road, as distance_m, latitude_deg, longitude_deg from point to point in the direction
    /// of travel (a map serves too). Without it the track of the first run is the road.
    #[arg(long, value_name = "ROAD.csv")]
    road: Option<PathBuf>,
    /// Runs to fuse, as `estimate` wrote them.
    #[arg(required = true, value_name = "RUN.csv")]
    runs: Vec<PathBuf>,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let road = match &args.road {
        Some(path) => road_from_file(path)?,
        None => road_from_runs(&args.runs)?,
    };
    let mut fused = GradeMap::new(&road);
    let mut unmatched = 0;
    for paths in args.runs.chunks(BATCH) {
        // Collected before they are judged: which error is told must not depend on threads.
        let runs: Vec<Result<Vec<RunRow>>> =
            paths.par_iter().map(|path| run_file::read(path)).collect();
        let runs = runs.into_iter().collect::<Result<Vec<_>>>()?;
        let rows: Vec<&[RunRow]> = runs.iter().map(Vec::as_slice).collect();
        let batch = map::fuse(&road, &rows);
        fused.merge(&batch.map);
        for (path, coverage) in paths.iter().zip(&batch.coverage) {
            eprintln!("{}", describe(path, coverage));
            unmatched += usize::from(coverage.matched == 0);
        }
    }
    let rows = fused.rows();
    if rows.is_empty() {
        return Err(Error::content(
            &args.runs[0],
            format!(
                "neither this nor another of {} runs covers a cell of the road; expected runs \
                 over the road, in its direction",
                args.runs.len()
            ),
        ));
    }
    if unmatched > 0 {
        eprintln!(
            "warning: {unmatched} of {} runs gave nothing",
            args.runs.len()
        );
    }
    map::write_map(&args.out, &rows)?;
    let km = rows.len() as f64 * map::GRID_M / 1000.0;
    eprintln!("{}: {} cells, {km:.2} km", args.out.display(), rows.len());
    if let Some(ratio) = fused.disagreement() {
        eprintln!(
            "runs differ by {:.2} times what their sigmas promise (squared: {ratio:.2})",
            ratio.sqrt()
        );
    }
    Ok(())
}

fn road_from_file(path: &Path) -> Result<RoadLine> {
    let points = map::read_road(path)?.iter().map(RoadRow::point).collect();
    RoadLine::new(points).map_err(|problem| Error::content(path, problem.to_string()))
}

/// The road of the first run that has a track.
fn road_from_runs(paths: &[PathBuf]) -> Result<RoadLine> {
    for path in paths {
        let track: Option<Vec<RoadPoint>> = map::road_of_run(&run_file::read(path)?);
        let Some(track) = track else {
            eprintln!(
                "warning: {}: no positions to take the road from",
                path.display()
            );
            continue;
        };
        return RoadLine::new(track).map_err(|problem| Error::content(path, problem.to_string()));
    }
    Err(Error::content(
        &paths[0],
        "no positions, nor in any other run; expected latitude_deg and longitude_deg in the rows",
    ))
}

fn describe(path: &Path, coverage: &Coverage) -> String {
    let Coverage {
        cells,
        matched,
        off_road,
        opposite,
        no_position,
    } = coverage;
    let warning = if *matched > 0 {
        ""
    } else if opposite > off_road {
        "; warning: drives the other way, fuse it with runs of its direction"
    } else {
        "; warning: nowhere on the road"
    };
    format!(
        "{}: {cells} cells: {matched} matched, {off_road} off the road, {opposite} in the \
         opposite direction, {no_position} without position{warning}",
        path.display()
    )
}
