//! The binary `roadgrade`.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    // Wrong usage ends inside parse() with exit code 2.
    match host_sim::cli::Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("roadgrade: {error}");
            ExitCode::from(1)
        }
    }
}
