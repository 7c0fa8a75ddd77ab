//! Runs every fault on simulated drives:
//!
//! ```text
//! cargo run -p cross-tests --release --example faults [-- --check | --write]
//! ```

use clap::Parser;
use cross_tests::exit_code;
use cross_tests::faults::matrix::{FaultRow, matrix};
use cross_tests::faults::table::{committed_file, table};
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::terminal::print::print;
use std::fs;
use std::process::ExitCode;

/// Puts faults into simulated drives, and reports their errors and counters.
#[derive(Parser)]
struct Options {
    /// Fail if the table is not that of tests/faults.md.
    #[arg(long)]
    check: bool,
    /// Write the table to tests/faults.md.
    #[arg(long, conflicts_with = "check")]
    write: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    let rows = matrix()?;
    let text = table(&rows);
    print(&text)?;
    let path = committed_file();
    if options.write {
        write_whole(&path, |file| file.write_all(text.as_bytes()))?;
    }
    if options.check && fs::read_to_string(&path).map_err(Error::io(&path))? != text {
        return Err(Error::content(&path, "is not this table; write it anew"));
    }
    let complaints: Vec<String> = rows.iter().flat_map(named).collect();
    if complaints.is_empty() {
        return Ok(());
    }
    Err(Error::content(&path, complaints.join("\n")))
}

fn named(row: &FaultRow) -> impl Iterator<Item = String> {
    let complaints = row.complaints().into_iter();
    complaints.map(|complaint| format!("{}: {complaint}", row.fault.name))
}
