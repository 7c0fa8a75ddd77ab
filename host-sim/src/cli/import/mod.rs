//! `roadgrade import`.

mod i3;
mod ztbus;

use crate::error::Result;
use clap::Subcommand;

/// Arguments of `import`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    source: ImportSource,
}

#[derive(Debug, Subcommand)]
enum ImportSource {
    /// Import trips of a BMW i3. Writes a signal table for each, and one vehicle.toml.
    I3(i3::Args),
    /// Import a ZTBus mission. Writes mission.csv, vehicle.toml and one signal table for each
    /// one-way trip.
    Ztbus(ztbus::Args),
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    match &args.source {
        ImportSource::I3(args) => i3::run(args),
        ImportSource::Ztbus(args) => ztbus::run(args),
    }
}
