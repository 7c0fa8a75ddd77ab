//! `roadgrade fuse`.

use crate::error::{Error, Result};
use crate::map::check_session_name;
use crate::map::pipeline::fuse_files::{FuseRequest, NamedSession, fuse_files};
use crate::map::pipeline::words;
use std::path::PathBuf;

/// Arguments of `fuse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each run is placed on the road by position and course; the odometer only carries from one \
    position to the next. Where a run is off the road, crosses it or drives it the other way, it \
    adds nothing. Smoothed grades and altitudes are then weighted by the inverse of their \
    variances, every 2.5 m. Cells that no run covers have no row in the map.\n\n\
    Runs of one vehicle on one day share its errors, so more of them help less and less: name \
    them with --session, and they count as one estimate whose variance keeps the share that they \
    have in common. The sessions then make the map, less a smaller share common to all. Both \
    shares are learned from how far runs disagree; runs that disagree more than their sigmas \
    allow make the map's sigmas larger.\n\n\
    A network has many ways, each in one direction of travel: lines of a GeoJSON file with a \
    property \"way\" (else @id, id, osm_id, or the feature's id), in both directions unless \"oneway\" \
    says yes (or -1: against its points; roundabouts and motorways are one-way without it). A run \
    passes from way to way where they share a point or one ends at another; a parallel road or a \
    bridge above is not entered. The map then has columns way and direction, and distances count \
    along each way in that direction.\n\n\
    With --store the sums behind the map are kept in a file, and later runs are added to them \
    without the earlier ones; its size depends on the road and on the sessions that have names, \
    not on the number of runs (a line each). It is written now and then on the way: a fusion that \
    was interrupted goes on from there when it is started again. A run that is in the map \
    already, whatever its file is called now, is not counted again.\n\n\
    A folder stands for all runs in it and its folders (.parquet, .csv), as those of \
    `estimate --dataset`. A damaged file in a folder is named and left out whole, and the exit \
    status is still 0 (--strict: 1, and no map); a damaged file that is named here is an error. \
    A RUN.parquet knows its session if `estimate --day` has told it.\n\n\
    Files are CSV or, if their names end in .parquet, Parquet; SUMS.csv is CSV. Give --road where \
    runs come in no order: without it the first one decides where cells begin.\n\n\
    Examples:\n  \
    roadgrade fuse --out map.csv monday.csv tuesday.csv\n  \
    roadgrade fuse --out map.parquet --road road.csv --store sums.csv runs/tile=N47E008\n  \
    roadgrade fuse --out a1.parquet --placed placed runs     (for SQL: host-sim/sql/fuse.sql)\n  \
    roadgrade fuse --out map.parquet --road network.geojson runs\n  \
    roadgrade fuse --out map.csv --session truck7=a1.csv,a2.csv,a3.csv b.csv\n  \
    roadgrade fuse --out map.csv --store sums.csv --session truck7=a4.csv"
)]
pub struct Args {
    /// Where the map goes: distance_m, latitude_deg, longitude_deg, altitude_m, grade_percent,
    /// grade_sigma_percent, runs; of a network, way and direction come first.
    #[arg(long, value_name = "MAP.csv")]
    out: PathBuf,
    /// The road, as distance_m, latitude_deg, longitude_deg from point to point in the direction
    /// of travel (a map serves too), or a network: the same with a column way, or a GeoJSON file
    /// of LineStrings. Without it the road is that of the store, or else the track of the first
    /// run.
    #[arg(long, value_name = "ROAD.csv|NET.geojson")]
    road: Option<PathBuf>,
    /// Runs of one vehicle in one session, under a name; may be repeated, for other sessions and
    /// for the same.
    #[arg(long = "session", value_name = "NAME=RUN.csv,RUN.csv", value_parser = session)]
    sessions: Vec<NamedSession>,
    /// Sums to start from, if the file exists; written with the new runs in them. Without runs,
    /// the map of the sums.
    #[arg(long, value_name = "SUMS.csv")]
    store: Option<PathBuf>,
    /// Where each run goes as it lies on the road, as DIR/road=MAP/*.parquet, MAP being the name
    /// of the map's file: from these, SQL makes the same map.
    #[arg(long, value_name = "DIR")]
    placed: Option<PathBuf>,
    /// A damaged file in a folder is an error.
    #[arg(long)]
    strict: bool,
    /// Runs to fuse, or folders of them, as `estimate` wrote them, each a session of its own
    /// unless it tells another.
    #[arg(required_unless_present_any = ["sessions", "store"], value_name = "RUN")]
    runs: Vec<PathBuf>,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    if args.store.as_ref() == Some(&args.out) {
        let problem = "--store and --out name the same file; expected two";
        return Err(Error::Usage(problem.to_owned()));
    }
    let fused = fuse_files(&FuseRequest {
        runs: &args.runs,
        sessions: &args.sessions,
        road: args.road.as_deref(),
        store: args.store.as_deref(),
        placed: args.placed.as_deref(),
        out: &args.out,
        strict: args.strict,
    })?;
    words::report(&args.out, &fused);
    Ok(())
}

/// A session from the command line.
fn session(argument: &str) -> std::result::Result<NamedSession, String> {
    let expected = "expected NAME=RUN.csv,RUN.csv";
    let (name, runs) = argument.split_once('=').ok_or(expected)?;
    check_session_name(name)
        .map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))?;
    let runs: Vec<PathBuf> = runs.split(',').map(PathBuf::from).collect();
    if runs.iter().any(|path| path.as_os_str().is_empty()) {
        return Err(expected.to_owned());
    }
    Ok(NamedSession {
        name: name.to_owned(),
        runs,
    })
}
