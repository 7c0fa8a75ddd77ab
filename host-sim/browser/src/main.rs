//! The program of the page in a browser: `roadgrade map` for the files that a user drops on it.
//!
//! It runs as WebAssembly with a system interface (WASI), which the scripts of the page provide: the
//! files are in memory, and nothing else is there. Arguments are the names of the dropped files.
//! Each line on standard output is a step of the work. Results are in the folder [`RESULTS`]. Exit
//! code 1 means that it could not be done; standard error has the reason.

#![warn(missing_docs)]

mod dropped;

use dropped::Dropped;
use estimator_core::Tuning;
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::logs_to_map::{Job, drives, make};
use host_sim::terminal::print::{alert, print};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Folder of the results: those of `roadgrade map`, and the summaries of its `--json`.
const RESULTS: &str = "/.results";
/// Folder of temporary files. The standard library knows none here.
const TEMPORARY: &str = "/.tmp";

fn main() -> ExitCode {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    // The first one counts, and this is the first one.
    let _ = tempfile::env::override_temp_dir(Path::new(TEMPORARY));
    match run(&files, Path::new(RESULTS)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            alert(format_args!("{error}"));
            ExitCode::FAILURE
        }
    }
}

fn run(files: &[PathBuf], results: &Path) -> Result<()> {
    let dropped = Dropped::sort(files)?;
    let job = Job {
        drives: drives(&dropped.logs, false),
        vehicle: dropped.vehicle,
        like: None,
        roads: None,
        tuning: Tuning::default(),
        options: dropped.options,
        keep_suspect: false,
    };
    let made = make(job, tell)?;
    tell("writing the page");
    made.write(results)?;
    let json = made.to_json().to_string();
    write_whole(&results.join("summary.json"), |out| {
        out.write_all(json.as_bytes())
    })
}

/// Prints a step of the work. The page that would show it may be closed.
fn tell(step: &str) {
    let _: std::result::Result<(), Error> = print(&format!("{step}\n"));
}
