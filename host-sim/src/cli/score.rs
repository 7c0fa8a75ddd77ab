//! `roadgrade score`.

use super::Cli;
use crate::error::{Error, Result};
use crate::run_file::{self, write_csv};
use crate::score::{self, ScoreRow, mean, score_run};
use crate::truth_file;
use clap::CommandFactory;
use std::path::{Path, PathBuf};

/// Arguments of `score`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Cells are compared with the truth at their time, both counted from the log's first frame. \
    The first and last 500 m of each run are left out. For the smoothed, the lagged and the live \
    grade: RMSE over all cells and over valid cells (neither a gear shift nor braking), bias \
    (estimate minus truth), and the mean normalised squared error (near 1 if the sigmas are \
    honest); then the means over runs.\n\n\
    Example: roadgrade score --truth a1.truth.csv --truth a2.truth.csv a1.csv a2.csv"
)]
pub struct Args {
    /// The truth of the drive; once for all runs, or repeated, one for each run in their order.
    #[arg(long, required = true, value_name = "TRUTH.csv")]
    truth: Vec<PathBuf>,
    /// Where the table goes as CSV [default: score.csv beside the first run].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    /// Runs to judge, as `estimate` wrote them.
    #[arg(required = true, value_name = "RUN.csv")]
    runs: Vec<PathBuf>,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    if args.truth.len() != 1 && args.truth.len() != args.runs.len() {
        let problem = format!(
            "{} times --truth for {} runs; expected one for all, or one for each run",
            args.truth.len(),
            args.runs.len()
        );
        Cli::command()
            .error(clap::error::ErrorKind::WrongNumberOfValues, problem)
            .exit();
    }
    let mut rows = Vec::new();
    let mut truth = Vec::new();
    for (i, path) in args.runs.iter().enumerate() {
        if let Some(truth_path) = args.truth.get(i) {
            truth = truth_file::read(truth_path)?;
        }
        let run = run_file::read(path)?;
        let scored = score_run(&path.display().to_string(), &run, &truth)
            .map_err(|problem| Error::content(path, problem.to_string()))?;
        if scored.beyond_truth > 0 {
            eprintln!(
                "{}: {} of {} cells left out, beyond the time span of the truth",
                path.display(),
                scored.beyond_truth,
                run.len()
            );
        }
        rows.extend(scored.rows);
    }
    if args.runs.len() > 1 {
        rows.extend(mean(&rows));
    }
    let out = args.out.clone().unwrap_or_else(|| {
        args.runs[0]
            .parent()
            .unwrap_or(Path::new(""))
            .join("score.csv")
    });
    write_csv(&out, rows.iter().map(ScoreRow::rounded))?;
    if args.json {
        println!("{}", score::json(&rows));
    } else {
        println!("{}", score::table(&rows));
    }
    eprintln!("{}", out.display());
    Ok(())
}
