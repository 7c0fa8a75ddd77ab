//! Shows each line in which the estimator's behaviour differs from the committed one:
//!
//! ```text
//! cargo run -p cross-tests --release --example change_indicator [-- --write]
//! ```

use clap::Parser;
use cross_tests::change_indicator::{changes, indicate, write};
use cross_tests::exit_code;
use host_sim::error::Result;
use host_sim::terminal::print::print;
use std::process::ExitCode;

/// Compares the results of a fixed set of inputs with tests/change_indicator.
#[derive(Parser)]
struct Options {
    /// Accept the results: write them to tests/change_indicator.
    #[arg(long)]
    write: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => exit_code(Err(error)),
    }
}

/// Returns whether nothing differs, or the differences were accepted.
fn run(options: &Options) -> Result<bool> {
    let indicated = indicate()?;
    let mut differs = false;
    for indication in &indicated.indications {
        let changes = changes(indication);
        differs |= !changes.is_empty();
        print(&changes)?;
    }
    for input in &indicated.absent {
        eprintln!("absent, not compared: {input}");
    }
    if options.write {
        write(&indicated)?;
    }
    Ok(options.write || !differs)
}
