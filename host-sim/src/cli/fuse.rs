//! `roadgrade fuse`.

use super::outputs;
use crate::error::{Error, Result};
use crate::files::stop::Stop;
use crate::map::pipeline::fuse_files::{FuseRequest, fuse_files};
use crate::map::pipeline::inputs::NamedSession;
use crate::map::pipeline::words;
use crate::map::{GRID_M, check_session_name};
use crate::terminal::print::print;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fuse`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade fuse --out map.csv monday.csv tuesday.csv",
    after_long_help = "Each run is matched to the road by position and course; the odometer bridges the gaps between \
    positions. Cells off the road, on crossing roads or in the opposite direction are not used. \
    Smoothed grades and altitudes are then averaged every 2.5 m with inverse-variance weights. \
    A cell that its run marks as suspect counts with four times its sigma. Cells that no run covers \
    have no row in the map.\n\n\
    Errors of runs of one vehicle on one day are correlated, so each further run adds less \
    information. Name these runs with --session: they then count as one estimate, whose variance \
    includes the common part. The map is the mean over sessions, which have a smaller common part \
    too. Both common parts are estimated from the disagreement of the runs. If runs disagree more \
    than their sigmas allow, the sigmas of the map increase.\n\n\
    A network has many ways, each in one direction of travel. They are lines of a GeoJSON file with \
    a property \"way\" (else @id, id, osm_id, or the id of the feature), or the roads for vehicles of an \
    OpenStreetMap extract (.osm.pbf), named way/ID. A way has both directions \
    unless \"oneway\" is yes, or -1 (against its points); roundabouts and motorways are one-way by \
    default. A run can change ways where they share a point, or where one ends at another. It \
    does not enter a parallel road or a bridge above. The map then has the columns way and \
    direction. Distances count along each way in that direction.\n\n\
    --store keeps the sums behind the map in a file, so that later runs can be added without the \
    earlier ones. The size of the file depends on the road and on the named sessions, and only \
    by one line per run on the number of runs. The file is updated during the fusion; an \
    interrupted fusion continues from the last update. A run that is already in the map is not \
    counted again, even if its file has a new name.\n\n\
    A folder means all runs in it and in its subfolders (.parquet, .csv), such as those of \
    `estimate --dataset`. A damaged file in a folder is reported and left out, and the exit status \
    is still 0 (with --strict it is 1, and there is no map). A damaged file that is named here is \
    an error. A RUN.parquet has its session if `estimate` ran with --day.\n\n\
    Files are Parquet if their names end in .parquet, else CSV. SUMS.csv is always CSV. Give --road \
    if the order of the runs may vary: without it, the first run decides where cells begin.\n\n\
    Examples:\n  \
    roadgrade fuse --out map.csv monday.csv tuesday.csv\n  \
    roadgrade fuse --out map.parquet --road road.csv --store sums.csv runs/tile=N47E008\n  \
    roadgrade fuse --out a1.parquet --placed placed runs     (for SQL: host-sim/sql/fuse.sql)\n  \
    roadgrade fuse --out map.parquet --road network.geojson runs\n  \
    roadgrade fuse --out map.csv --session truck7=a1.csv,a2.csv,a3.csv b.csv\n  \
    roadgrade fuse --out map.csv --store sums.csv --session truck7=a4.csv"
)]
pub struct Args {
    /// File for the map. Columns: distance_m, latitude_deg, longitude_deg, altitude_m, grade_percent,
    /// grade_sigma_percent, runs. For a network, way and direction come first.
    #[arg(long, value_name = "MAP.csv")]
    out: PathBuf,
    /// Road or network. A road has the columns distance_m, latitude_deg and longitude_deg, one row
    /// per point in the direction of travel; a map is accepted too. A network has a column way in
    /// addition, or is a GeoJSON file of LineStrings, or an OpenStreetMap extract [default: the
    /// road of the store, else the track of the first run].
    #[arg(long, value_name = "ROAD.csv|NET.geojson|NET.osm.pbf")]
    road: Option<PathBuf>,
    /// Runs of one vehicle in one named session. Repeat the option for other sessions, or for more
    /// runs of the same session.
    #[arg(long = "session", value_name = "NAME=RUN.csv,RUN.csv", value_parser = session)]
    sessions: Vec<NamedSession>,
    /// File of the sums: read if it exists, and written with the new runs added. Without runs, the
    /// map is made of these sums.
    #[arg(long, value_name = "SUMS.csv")]
    store: Option<PathBuf>,
    /// Folder for the runs as placed on the road, DIR/road=MAP/*.parquet, where MAP is the name of
    /// the map file. SQL computes the same map from these files.
    #[arg(long, value_name = "DIR", hide_short_help = true)]
    placed: Option<PathBuf>,
    /// Treat a damaged file in a folder as an error.
    #[arg(long, hide_short_help = true)]
    strict: bool,
    /// Print what the map has as JSON.
    #[arg(long)]
    json: bool,
    /// Runs to fuse, or folders of runs, as `estimate` wrote them. A run that names no session is a
    /// session of its own.
    #[arg(required_unless_present_any = ["sessions", "store"], value_name = "RUN")]
    runs: Vec<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if args.store.as_ref() == Some(&args.out) {
        let problem = "--store and --out name the same file; expected two different files";
        return Err(Error::Usage(problem.to_owned()));
    }
    outputs::check_file(&args.out, &["csv", "parquet"])?;
    if let Some(store) = &args.store {
        outputs::check_file(store, &["csv"])?;
    }
    let fused = fuse_files(&FuseRequest {
        runs: &args.runs,
        sessions: &args.sessions,
        road: args.road.as_deref(),
        store: args.store.as_deref(),
        placed: args.placed.as_deref(),
        out: Some(&args.out),
        strict: args.strict,
        stop: &Stop::default(),
    })?;
    words::report(&args.out, &fused);
    if !args.json {
        return Ok(());
    }
    let cells: usize = fused.ways.iter().map(|way| way.rows.len()).sum();
    let summary = json!({
        "map": args.out,
        "cells": cells,
        "km": cells as f64 * GRID_M * 1e-3,
        "ways": fused.ways.len(),
    });
    print(&format!("{summary}\n"))
}

/// Parses NAME=RUN.csv,RUN.csv.
pub(super) fn session(argument: &str) -> std::result::Result<NamedSession, String> {
    let expected = "expected NAME=RUN.csv,RUN.csv";
    let (name, runs) = argument.split_once('=').ok_or(expected)?;
    check_session_name(name).map_err(|flaw| flaw.to_string())?;
    let runs: Vec<PathBuf> = runs.split(',').map(PathBuf::from).collect();
    if runs.iter().any(|path| path.as_os_str().is_empty()) {
        return Err(expected.to_owned());
    }
    Ok(NamedSession {
        name: name.to_owned(),
        runs,
    })
}
