//! Makes evidence and compares it with what is committed:
//!
//! ```text
//! cargo run -p evidence -- requirements [--write]
//! cargo run -p evidence -- calls IMAGE [--write]
//! cargo run -p evidence -- stack IMAGE FUNCTIONS
//! cargo run -p evidence -- coverage FILE.lcov
//! cargo run -p evidence -- mutants MISSED.txt
//! ```

use clap::{Parser, Subcommand};
use evidence::call_graph::{CallGraph, StackBound};
use evidence::calls::{CallBounds, committed_calls};
use evidence::exceptions::{Coverage, ExceptionCount, Measured, Mutants};
use evidence::files::{Result, problem, text};
use evidence::pages::pages;
use evidence::requirements::Requirements;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Where the measured lines are.
const MEASURED: &str = "estimator-core/src";

#[derive(Parser)]
struct Options {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Requirements and tests, both ways, and the generated parts of the pages.
    Requirements {
        /// Write the pages.
        #[arg(long)]
        write: bool,
    },
    /// The stack of each call, from the linked image.
    Calls {
        /// The image `alone_calls`.
        image: PathBuf,
        /// Commit the bounds: write them to firmware/calls.csv.
        #[arg(long)]
        write: bool,
    },
    /// The stack of the functions of any image whose names begin so.
    Stack {
        /// A linked image for Cortex-M.
        image: PathBuf,
        /// Begin of their names, as in `firmware::calls::`.
        functions: String,
    },
    /// Lines and branches that no test reaches and no exception names.
    Coverage {
        /// A measurement in the format of lcov.
        lcov: PathBuf,
    },
    /// Mutants that no test catches and no reason is given for.
    Mutants {
        /// The list of cargo-mutants, `missed.txt`.
        missed: PathBuf,
    },
}

fn main() -> ExitCode {
    let done = match Options::parse().what {
        What::Requirements { write } => requirements(write),
        What::Calls { image, write } => calls(&image, write),
        What::Stack { image, functions } => stack(&image, &functions),
        What::Coverage { lcov } => coverage(&lcov),
        What::Mutants { missed } => mutants(&missed),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn requirements(write: bool) -> Result<()> {
    let requirements = Requirements::read()?;
    let problems = requirements.problems()?;
    if !problems.is_empty() {
        return Err(problems.join("\n"));
    }
    for page in pages()? {
        if page.current == page.committed {
            continue;
        }
        if !write {
            let how = "not current: cargo run -p evidence -- requirements --write";
            return Err(problem(&page.path, how));
        }
        fs::write(&page.path, &page.current).map_err(|error| problem(&page.path, error))?;
    }
    println!("{} requirements", requirements.iter().count());
    Ok(())
}

fn calls(image: &Path, write: bool) -> Result<()> {
    let (bounds, paths) = CallBounds::of_image(image)?;
    print_paths(&paths);
    print!("{}", bounds.to_csv());
    let path = committed_calls();
    if write {
        return fs::write(&path, bounds.to_csv()).map_err(|error| problem(&path, error));
    }
    let excesses = bounds.excesses(&CallBounds::read(&path)?);
    if excesses.is_empty() {
        return Ok(());
    }
    Err(problem(&path, excesses.join("\n")))
}

fn stack(image: &Path, functions: &str) -> Result<()> {
    let graph = CallGraph::read(image, functions)?;
    let bounds = graph.stack_bounds(functions);
    print_paths(&bounds.map_err(|why| problem(image, why))?);
    Ok(())
}

fn print_paths(bounds: &BTreeMap<String, StackBound>) {
    for (name, bound) in bounds {
        println!("{name}: {} bytes", bound.bytes);
        for function in &bound.path {
            println!("    {function}");
        }
    }
}

fn coverage(path: &Path) -> Result<()> {
    let measured = Measured::of_lcov(&text(path)?, MEASURED);
    let exceptions = Coverage::read()?;
    let beyond = exceptions.beyond(&measured)?;
    let (lines, branches) = exceptions.count();
    println!("what,count,covered,argued,open");
    for (what, (all, covered), exceptions) in [
        ("lines", measured.lines, lines),
        ("branches", measured.branches, branches),
    ] {
        let ExceptionCount { argued, open } = exceptions;
        println!("{what},{all},{covered},{argued},{open}");
    }
    let needless = exceptions.needless(&measured)?;
    let problems: Vec<String> = [
        (beyond, "places without a test or a reason"),
        (needless, "exceptions that a test reaches"),
    ]
    .into_iter()
    .filter(|(places, _)| !places.is_empty())
    .map(|(places, what)| format!("{} {what}:\n{}", places.len(), places.join("\n")))
    .collect();
    if problems.is_empty() {
        return Ok(());
    }
    Err(problems.join("\n"))
}

fn mutants(path: &Path) -> Result<()> {
    let text = text(path)?;
    let mutants = Mutants::read()?;
    let beyond = mutants.beyond(&text);
    if beyond.is_empty() {
        return Ok(());
    }
    Err(format!("mutants without a reason:\n{}", beyond.join("\n")))
}
