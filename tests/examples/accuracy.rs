//! Judges the estimator on drives of other simulators and on measured vehicles:
//!
//! ```text
//! cargo run -p cross-tests --example accuracy [-- --write | [--quick] [--tuning FILE.toml] [NAME...]]
//! ```

use clap::Parser;
use cross_tests::accuracy::limits::compare;
use cross_tests::accuracy::subject::{OTHERS, QUICK, measure};
use cross_tests::accuracy::table::{committed, committed_file, text, write};
use cross_tests::exit_code;
use host_sim::error::{Error, Result};
use host_sim::files::tuning::read_or_default;
use host_sim::terminal::print::print;
use std::path::PathBuf;
use std::process::ExitCode;

/// Prints the errors beside those of tests/accuracy.csv. Fails if one is worse than allowed.
#[derive(Parser)]
struct Options {
    /// Accept the errors: write them to tests/accuracy.csv.
    #[arg(long)]
    write: bool,
    /// Judge with another tuning.
    #[arg(long, conflicts_with = "write", value_name = "FILE.toml")]
    tuning: Option<PathBuf>,
    /// Judge only what has these names in the table.
    #[arg(conflicts_with = "write")]
    names: Vec<String>,
    /// Judge only what `tests/run` judges.
    #[arg(long, conflicts_with = "write")]
    quick: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    let mut subjects = QUICK.to_vec();
    if !options.quick {
        subjects.extend(OTHERS);
    }
    if !options.names.is_empty() {
        let is_named = |name: &String| options.names.contains(name);
        subjects.retain(|subject| subject.names().iter().any(is_named));
    }
    let measured = measure(&subjects, &read_or_default(options.tuning.as_deref())?)?;
    if !measured.absent.is_empty() {
        eprintln!("absent, not judged: {}", measured.absent.join(", "));
    }
    if options.write {
        print(&(text(&measured.rows, &[]) + "\n"))?;
        return write(&measured.rows, &measured.absent);
    }
    let committed = committed()?;
    print(&(text(&measured.rows, &committed) + "\n"))?;
    let worse = compare(&measured.rows, &committed).worse;
    if worse.is_empty() {
        return Ok(());
    }
    Err(Error::content(&committed_file(), worse.join("\n")))
}
