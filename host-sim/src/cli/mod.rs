//! The command line: one file a subcommand.

mod conclusion;
mod demo;
mod diagnose;
mod estimate;
mod export;
mod fuse;
mod import;
mod inspect;
#[cfg(target_os = "linux")]
mod listen;
#[cfg(target_os = "linux")]
mod replay;
mod score;
mod simulate;
mod study;
#[cfg(not(target_os = "linux"))]
mod without_can;
#[cfg(not(target_os = "linux"))]
use without_can as listen;
#[cfg(not(target_os = "linux"))]
use without_can as replay;

use crate::error::{Error, Result};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

/// Road-grade estimation for heavy vehicles: from bus traffic to a grade map.
#[derive(Debug, Parser)]
#[command(name = "roadgrade", version, propagate_version = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate, put on a bus, estimate, fuse, score and report, on a built-in scenario.
    Demo(demo::Args),
    /// Drive simulated trucks over a road and write their bus logs and the truth.
    Simulate(simulate::Args),
    /// Estimate the grade along one recorded drive.
    Estimate(estimate::Args),
    /// Turn measured data sets into signal tables.
    Import(import::Args),
    /// Show what is on a bus, and what an estimate would miss.
    Inspect(inspect::Args),
    /// Put a recorded log on a CAN interface.
    Replay(replay::Args),
    /// Estimate the grade live, from CAN interfaces.
    Listen(listen::Args),
    /// Fuse runs over the same road into one map.
    Fuse(fuse::Args),
    /// Show a map elsewhere: GeoJSON, a CSV file a way, or a page.
    Export(export::Args),
    /// Compare runs with the truth.
    Score(score::Args),
    /// Find what the vehicle model lacks, and add it.
    Diagnose(diagnose::Args),
    /// Compute tables and figures from measured data and from the thesis.
    Study(study::Args),
}

impl Cli {
    /// Runs the subcommand. Wrong usage ends the program with exit code 2.
    ///
    /// # Errors
    /// What could not be done, with file, line and what was expected.
    pub fn run(&self) -> Result<()> {
        self.dispatch().map_err(|error| match error {
            Error::Usage(problem) => Self::command()
                .error(ErrorKind::ArgumentConflict, problem)
                .exit(),
            other => other,
        })
    }

    fn dispatch(&self) -> Result<()> {
        match &self.command {
            Command::Demo(args) => demo::run(args),
            Command::Simulate(args) => simulate::run(args),
            Command::Estimate(args) => estimate::run(args),
            Command::Import(args) => import::run(args),
            Command::Inspect(args) => inspect::run(args),
            Command::Replay(args) => replay::run(args),
            Command::Listen(args) => listen::run(args),
            Command::Fuse(args) => fuse::run(args),
            Command::Export(args) => export::run(args),
            Command::Score(args) => score::run(args),
            Command::Diagnose(args) => diagnose::run(args),
            Command::Study(args) => study::run(args),
        }
    }
}
