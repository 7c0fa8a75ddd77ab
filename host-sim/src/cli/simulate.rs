//! `roadgrade simulate`.

use crate::error::Result;
use crate::simulator::scenario::Scenario;
use crate::simulator::write_runs;
use std::path::PathBuf;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// What to simulate (TOML); see `host-sim/scenarios` for examples.
    #[arg(long, value_name = "FILE")]
    scenario: PathBuf,
    /// Where NAME.log, NAME.truth.csv, NAME.vehicle.toml (what is believed of the vehicle) and
    /// NAME.oracle.toml (what is true of it, and of the noise; for `score`) of each run go, the
    /// road.csv, and vehicle.toml if all runs share one vehicle.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Runs it.
///
/// # Errors
/// A scenario that cannot be, or what the file system says.
pub fn run(args: &Args) -> Result<()> {
    write_runs(&Scenario::read(&args.scenario)?, &args.out)
}
