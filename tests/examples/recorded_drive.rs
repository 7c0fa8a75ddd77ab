//! Writes a small drive as boards read it, and the cells that they must write:
//!
//!     cargo run -p cross-tests --example recorded_drive -- FOLDER
//!
//! writes `drive.bin` and `expected.bin` for a vehicle with every effect.

use clap::Parser;
use cross_tests::drive::{drive, truck_with_every_effect};
use cross_tests::emulator::{drive_file, on_host};
use cross_tests::exit_code;
use firmware::exchange::cell;
use host_sim::error::Result;
use host_sim::files::output::write_whole;
use std::path::PathBuf;
use std::process::ExitCode;

/// Writes a small drive, and the cells that this machine makes of it.
#[derive(Debug, Parser)]
struct Args {
    /// Folder for both files.
    folder: PathBuf,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> Result<()> {
    let (model, frames) = (truck_with_every_effect(), drive());
    let cells: Vec<u8> = on_host(&model, &frames)
        .iter()
        .flat_map(cell::encode)
        .collect();
    let write =
        |name: &str, bytes: &[u8]| write_whole(&args.folder.join(name), |out| out.write_all(bytes));
    write("drive.bin", &drive_file(&model, &frames))?;
    write("expected.bin", &cells)
}
