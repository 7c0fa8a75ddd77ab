//! The binary `roadgrade`.

use host_sim::cli::Cli;
use host_sim::error::Error;
use host_sim::terminal::print::alert;
use std::process::ExitCode;

fn main() -> ExitCode {
    // Wrong usage ends inside parse() with exit code 2.
    match Cli::run_arguments(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Error::Usage(problem)) => Cli::end_with_usage(&problem),
        Err(error) => {
            alert(format_args!("roadgrade: {error}"));
            ExitCode::from(1)
        }
    }
}
