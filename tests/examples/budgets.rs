//! Counts what the estimator costs on each target and in each scalar, on the emulated board:
//!
//! ```text
//! cargo run -p cross-tests --release --example budgets [-- --check | --write | --peers | --seconds 920]
//! ```

use clap::Parser;
use cross_tests::budgets::{Budgets, CORTEX_M4F, committed_file, measure, measure_on};
use cross_tests::drive::drive_for;
use cross_tests::{emulator, exit_code, peers};
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::terminal::print::print;
use std::path::Path;
use std::process::ExitCode;

#[derive(Parser)]
struct Options {
    /// Fail if a figure exceeds the committed one, or its limit.
    #[arg(long)]
    check: bool,
    /// Commit the figures: write them to firmware/budgets.csv.
    #[arg(long, conflicts_with = "check")]
    write: bool,
    /// Count other Kalman filters instead.
    #[arg(long, conflicts_with_all = ["check", "write"])]
    peers: bool,
    /// Count on a drive of this duration, on a Cortex-M4F: 920 are 20 km.
    #[arg(long, conflicts_with_all = ["check", "write", "peers"])]
    seconds: Option<u32>,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    if let Some(what) = emulator::missing() {
        return Err(Error::content(Path::new("budgets"), what));
    }
    if options.peers {
        return print(&(peers::table()? + "\n"));
    }
    let budgets = match options.seconds {
        Some(seconds) => measure_on([CORTEX_M4F], &drive_for(f64::from(seconds)))?,
        None => measure()?,
    };
    print(&(budgets.to_text() + "\n"))?;
    let path = committed_file();
    if options.write {
        write_whole(&path, |file| file.write_all(budgets.to_csv().as_bytes()))?;
    }
    if options.check {
        let mut excesses = budgets.excesses(&Budgets::read(&path)?);
        excesses.extend(budgets.beyond_limits());
        if !excesses.is_empty() {
            return Err(Error::content(&path, excesses.join("\n")));
        }
    }
    Ok(())
}
