//! Encodes a vehicle file as a board reads it from its flash:
//!
//!     cargo run --release -p cross-tests --example vehicle_image -- V.toml VEHICLE.bin

use clap::Parser;
use cross_tests::exit_code;
use estimator_core::packed_vehicle;
use host_sim::error::Result;
use host_sim::files::output::write_whole;
use host_sim::files::vehicle::VehicleFile;
use std::path::PathBuf;
use std::process::ExitCode;

/// Encodes a vehicle file for a board's flash.
#[derive(Debug, Parser)]
struct Args {
    /// The vehicle.
    #[arg(value_name = "V.toml")]
    vehicle: PathBuf,
    /// File to be flashed.
    #[arg(value_name = "VEHICLE.bin")]
    image: PathBuf,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> Result<()> {
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let image = packed_vehicle::encode(&vehicle.model);
    write_whole(&args.image, |out| out.write_all(&image))
}
