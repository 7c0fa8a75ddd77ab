//! `roadgrade simulate`.

use super::outputs;
use crate::error::Result;
use crate::simulator::scenario::Scenario;
use crate::simulator::{files_of, write_runs};
use crate::terminal::print::{note, print};
use std::path::PathBuf;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenario file (TOML). Examples are in `host-sim/scenarios`.
    #[arg(long, value_name = "FILE")]
    scenario: PathBuf,
    /// Output folder. Each run gets NAME.log, NAME.truth.csv, NAME.vehicle.toml (assumed
    /// parameters) and NAME.oracle.toml (true parameters and noise, for `score`). The folder also
    /// gets road.csv, and vehicle.toml if all runs share one vehicle.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print each run as JSON: run, vehicle, distance_km, duration_s, frames.
    #[arg(long, hide_short_help = true)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Returns an error of the scenario or of the file system.
pub fn run(args: &Args) -> Result<()> {
    let scenario = Scenario::read(&args.scenario)?;
    let written = files_of(&scenario, &args.out);
    let inputs = scenario.files.iter().map(PathBuf::as_path);
    outputs::check(
        inputs.chain([&*args.scenario]),
        written.iter().map(PathBuf::as_path),
    )?;
    let runs = write_runs(&scenario, &args.out)?;
    if args.json {
        let json = serde_json::to_string_pretty(&runs).expect("numbers are JSON");
        return print(&format!("{json}\n"));
    }
    for run in runs {
        note(format_args!("{run}"));
    }
    Ok(())
}
