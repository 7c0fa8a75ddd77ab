//! Measures what the estimator's numbers and mechanisms are worth, on drives of the accuracy guard:
//!
//! ```text
//! cargo run -p cross-tests --example sensitivity -- numbers [--write] [KEY...]
//! cargo run -p cross-tests --example sensitivity -- mechanisms [--write] [NAME...]
//! ```

use clap::{Parser, Subcommand};
use cross_tests::exit_code;
use cross_tests::sensitivity::{Change, mechanisms, numbers};
use host_sim::error::{Error, Result};
use host_sim::terminal::print::print;
use host_sim::terminal::table::text_table;
use std::process::ExitCode;
use std::time::Instant;

#[derive(Parser)]
struct Options {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// By how much errors change if a number is wrong by a factor of two: the worse of both directions.
    Numbers {
        /// Write the changes to tests/tuning_costs.csv.
        #[arg(long)]
        write: bool,
        /// Only the numbers of these keys. The rows of others stay.
        #[arg(value_name = "KEY")]
        keys: Vec<String>,
    },
    /// By how much errors change if a mechanism is off.
    Mechanisms {
        /// Write the changes to tests/mechanisms.csv.
        #[arg(long)]
        write: bool,
        /// Only those of these names. The rows of others stay.
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
}

fn main() -> ExitCode {
    let begun = Instant::now();
    let result = run(&Options::parse().what);
    eprintln!("{} s", begun.elapsed().as_secs());
    exit_code(result)
}

fn run(what: &What) -> Result<()> {
    match what {
        What::Numbers { write, keys } => {
            let (rows, failed) = parted(numbers::measure(&numbers::parameters(keys)?, *write)?);
            let cells = |row: &numbers::CostRow| (row.key.clone(), row.worse());
            show("number", rows.iter().map(cells))?;
            all_done(&failed)
        }
        What::Mechanisms { write, names } => {
            let (rows, failed) = parted(mechanisms::measure(
                &mechanisms::mechanisms(names)?,
                *write,
            )?);
            let cells = |row: &mechanisms::MechanismRow| (row.name.clone(), row.change());
            show("without", rows.iter().map(cells))?;
            all_done(&failed)
        }
    }
}

fn parted<R>(rows: Vec<Result<R>>) -> (Vec<R>, Vec<String>) {
    let (mut done, mut failed) = (Vec::new(), Vec::new());
    for row in rows {
        match row {
            Ok(row) => done.push(row),
            Err(error) => failed.push(error.to_string()),
        }
    }
    (done, failed)
}

fn show(first: &str, rows: impl Iterator<Item = (String, Change)>) -> Result<()> {
    let header = [first, "smoothed %", "lagged %", "live %", "NEES %"];
    let lines = rows.map(|(name, change)| [vec![name], change.words().to_vec()].concat());
    let lines: Vec<Vec<String>> = lines.collect();
    print(&(text_table(&header, &lines, 1).to_string() + "\n"))
}

fn all_done(failed: &[String]) -> Result<()> {
    if failed.is_empty() {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "not measured:\n{}",
        failed.join("\n")
    )))
}
