//! The command line: one file per subcommand.

mod columns;
mod conclusion;
mod demo;
mod diagnose;
mod estimate;
mod export;
mod export_slopes;
mod fuse;
mod horizon;
mod identify;
mod import;
mod inspect;
mod like_option;
#[cfg(target_os = "linux")]
mod listen;
mod log_files;
mod log_notes;
mod log_options;
mod map;
mod memory_option;
mod objects;
mod outputs;
mod pack;
mod place;
#[cfg(target_os = "linux")]
mod replay;
mod run_page;
mod score;
mod shell;
mod simulate;
#[cfg(feature = "studies")]
mod study;
mod told;
mod tuning_option;
#[cfg(not(all(target_os = "linux", feature = "studies")))]
mod without;
#[cfg(not(feature = "studies"))]
use without::study;
#[cfg(not(target_os = "linux"))]
use without::{can as listen, can as replay};

use crate::error::Result;
use crate::files::signals;
use crate::terminal::print::{be_quiet, printable};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use objects::Objects;
use std::ffi::OsString;

/// Road-grade estimation for heavy vehicles: from CAN data to a grade map.
#[derive(Debug, Parser)]
#[command(
    name = "roadgrade",
    version,
    propagate_version = true,
    after_help = "Inputs and outputs may be objects of S3 and its like: s3://BUCKET/KEY; credentials and endpoint are \
    in AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_REGION, AWS_ENDPOINT_URL. docs/usage.md says which commands."
)]
pub struct Cli {
    /// Print no messages and no progress: only results, warnings and errors.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the whole chain on a built-in scenario: simulate, estimate, fuse, score and report.
    Demo(demo::Args),
    /// Simulate trucks on a road and write their bus logs and the true grade.
    Simulate(simulate::Args),
    /// Estimate the grade along one recorded drive.
    Estimate(estimate::Args),
    /// Convert measured data sets to signal tables.
    Import(import::Args),
    /// Show which messages are in a log, and which inputs of an estimate are missing.
    Inspect(inspect::Args),
    /// List every signal: its column, unit and range, and the messages that have it.
    Columns(columns::Args),
    /// Send a recorded log on a CAN interface.
    Replay(replay::Args),
    /// Estimate the grade live, from CAN interfaces.
    Listen(listen::Args),
    /// Make a grade map of the logs of one vehicle.
    Map(map::Args),
    /// Fuse runs over the same road into one map.
    Fuse(fuse::Args),
    /// Place runs on their road, for an engine to sum.
    Place(place::Args),
    /// Convert a map to CSV or Parquet, GeoJSON, KML or GPX, to one CSV file per way, or to an HTML
    /// page.
    Export(export::Args),
    /// Write maps in the form that the vehicle reads.
    Pack(pack::Args),
    /// Write the grade ahead along a recorded drive, from a packed map.
    Horizon(horizon::Args),
    /// Write the vehicle file that logs ask for.
    Identify(identify::Args),
    /// Compare runs with the truth.
    Score(score::Args),
    /// Find effects that the vehicle model lacks, and add them to the vehicle file.
    Diagnose(diagnose::Args),
    /// Compute the tables and figures of the thesis, and those of measured data.
    Study(study::Args),
    /// Print the completions of a shell: bash, zsh, fish, elvish or powershell.
    Completions(shell::CompletionArgs),
    /// Write the man pages.
    #[command(hide = true)]
    Man(shell::ManArgs),
}

impl Cli {
    /// Runs the subcommand of a command line, with objects as files. Wrong usage ends the program
    /// with exit code 2.
    ///
    /// # Errors
    /// Returns the error of the subcommand, or of an object.
    pub fn run_arguments(arguments: impl IntoIterator<Item = OsString>) -> Result<()> {
        let arguments: Vec<OsString> = arguments.into_iter().collect();
        let cli = Self::parse_from(&arguments);
        if cli.quiet {
            be_quiet();
        }
        match Objects::of(&Self::command(), &arguments)? {
            None => cli.run(),
            Some(objects) => Self::parse_from(&objects.arguments).run(),
        }
    }

    /// Runs the subcommand.
    ///
    /// # Errors
    /// Returns the error of the subcommand. It names the file, the line and what was expected.
    pub fn run(&self) -> Result<()> {
        signals::watch();
        if self.quiet {
            be_quiet();
        }
        match &self.command {
            Command::Demo(args) => demo::run(args),
            Command::Simulate(args) => simulate::run(args),
            Command::Estimate(args) => estimate::run(args),
            Command::Import(args) => import::run(args),
            Command::Inspect(args) => inspect::run(args),
            Command::Columns(args) => columns::run(args),
            Command::Replay(args) => replay::run(args),
            Command::Listen(args) => listen::run(args),
            Command::Map(args) => map::run(args),
            Command::Fuse(args) => fuse::run(args),
            Command::Place(args) => place::run(args),
            Command::Export(args) => export::run(args),
            Command::Pack(args) => pack::run(args),
            Command::Horizon(args) => horizon::run(args),
            Command::Identify(args) => identify::run(args),
            Command::Score(args) => score::run(args),
            Command::Diagnose(args) => diagnose::run(args),
            Command::Study(args) => study::run(args),
            Command::Completions(args) => shell::completions(args, Self::command()),
            Command::Man(args) => shell::man(args, Self::command()),
        }
    }

    /// Ends the program as wrong options do: the problem, the usage, and exit code 2.
    pub fn end_with_usage(problem: &str) -> ! {
        Self::command()
            .error(ErrorKind::ArgumentConflict, printable(problem))
            .exit()
    }
}
