//! The binary `roadgrade`.

use clap::Parser;
use host_sim::terminal::print::note;
use std::process::ExitCode;

fn main() -> ExitCode {
    // Wrong usage ends inside parse() with exit code 2.
    match host_sim::cli::Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            note(format_args!("roadgrade: {error}"));
            ExitCode::from(1)
        }
    }
}
