//! Runs every fault and every manoeuvre on simulated drives:
//!
//! ```text
//! cargo run -p cross-tests --release --example faults [-- --check | --write | --only WORDS...]
//! ```

use clap::Parser;
use cross_tests::exit_code;
use cross_tests::fault_page::{FaultPage, committed_file, faults, manoeuvres};
use cross_tests::faults::matrix::matrix;
use cross_tests::faults::table::table;
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::terminal::print::print;
use std::process::ExitCode;

/// Puts faults and manoeuvres into simulated drives, and reports their errors and counters.
#[derive(Parser)]
struct Options {
    /// Print only the faults whose names contain this; may be repeated.
    #[arg(long, value_name = "WORDS", conflicts_with_all = ["check", "write"])]
    only: Vec<String>,
    /// Fail if the tables are not those of tests/faults.md.
    #[arg(long)]
    check: bool,
    /// Write the tables to tests/faults.md.
    #[arg(long, conflicts_with = "check")]
    write: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    if !options.only.is_empty() {
        return print(&table(&matrix(&options.only)?));
    }
    let path = committed_file();
    let committed = FaultPage::committed()?;
    let (faults, complaints) = faults()?;
    let page = FaultPage {
        faults,
        // Without the measured road they stay as they are.
        manoeuvres: manoeuvres()?.unwrap_or_else(|| committed.manoeuvres.clone()),
    };
    print(&page.text())?;
    if options.write {
        write_whole(&path, |file| file.write_all(page.text().as_bytes()))?;
    }
    if options.check && committed != page {
        return Err(Error::content(&path, "is not this page; write it anew"));
    }
    if complaints.is_empty() {
        return Ok(());
    }
    Err(Error::content(&path, complaints.join("\n")))
}
