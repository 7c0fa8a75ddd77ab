//! `roadgrade place`.

use super::fuse::session;
use crate::error::Result;
use crate::map::pipeline::inputs::NamedSession;
use crate::map::pipeline::place_files::{PlaceRequest, place_files};
use crate::terminal::print::{note, print};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `place`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade place --road network.geojson --out placed monday.csv",
    after_long_help = "Each run is matched to the road or network as `fuse` does it, and its cells are \
    written to DIR/road=ROAD/RUN.parquet, where ROAD is the name of the road file. An engine sums them \
    to the map that `fuse` makes: host-sim/sql/fuse.sql.\n\n\
    Runs are placed one by one, so an engine can spread them: one process for each partition of the \
    files, all with the same --out. A file appears whole or not at all. A process that was interrupted \
    can be started again: runs as Parquet that are there, placed on the same road, are not read again.\n\n\
    A damaged file in a folder is reported and left out, and the exit status is still 0 (with --strict \
    it is 1). A damaged file that is named here is an error.\n\n\
    Examples:\n  \
    roadgrade place --road a1.csv --out placed runs/tile=N47E008\n  \
    roadgrade place --road network.geojson --out placed monday.parquet tuesday.parquet"
)]
pub struct Args {
    /// Road or network, as `fuse` takes it.
    #[arg(long, value_name = "ROAD.csv|NET.geojson|NET.osm.pbf")]
    road: PathBuf,
    /// Folder for the placed runs.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Runs of one vehicle in one named session. Repeat the option for other sessions, or for more
    /// runs of the same session.
    #[arg(long = "session", value_name = "NAME=RUN.csv,RUN.csv", value_parser = session)]
    sessions: Vec<NamedSession>,
    /// Treat a damaged file in a folder as an error.
    #[arg(long, hide_short_help = true)]
    strict: bool,
    /// Print how many runs were placed as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Runs to place, or folders of runs, as `estimate` wrote them. A run that names no session is a
    /// session of its own.
    #[arg(required_unless_present = "sessions", value_name = "RUN")]
    runs: Vec<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let tally = place_files(&PlaceRequest {
        runs: &args.runs,
        sessions: &args.sessions,
        road: &args.road,
        out: &args.out,
        strict: args.strict,
    })?;
    note(format_args!(
        "{} runs placed, {} there already, {} without a cell on the road, {} damaged",
        tally.placed, tally.there, tally.unmatched, tally.damaged
    ));
    if !args.json {
        return Ok(());
    }
    let summary = json!({
        "placed": tally.placed,
        "there": tally.there,
        "unmatched": tally.unmatched,
        "damaged": tally.damaged,
        "cells": tally.cells,
    });
    print(&format!("{summary}\n"))
}
