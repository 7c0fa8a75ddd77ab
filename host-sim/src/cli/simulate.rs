//! `roadgrade simulate`.

use crate::error::Result;
use crate::simulator::scenario::Scenario;
use crate::simulator::write_runs;
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
}

/// Runs the command.
///
/// # Errors
/// Returns an error of the scenario or of the file system.
pub fn run(args: &Args) -> Result<()> {
    write_runs(&Scenario::read(&args.scenario)?, &args.out)
}
