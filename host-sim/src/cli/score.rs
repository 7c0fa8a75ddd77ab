//! `roadgrade score`.

use super::log_files::of_kind;
use super::outputs;
use crate::error::{Error, Result, on_one_line};
use crate::files::csv::write_csv;
use crate::files::kind::Kind;
use crate::files::truth;
use crate::score::companions::{Companions, NamedFiles};
use crate::score::judged::{Judged, judge};
use crate::score::{self, ScoreRow, mean};
use crate::terminal::print::{note, print};
use crate::terminal::progress;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Options that name the companion files: once for all runs, or once for each run.
#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// Log that the run was estimated from. The comparison rows need it. Give it once for all runs,
    /// or once for each run [default: NAME.log or NAME.log.gz beside NAME.truth.csv].
    #[arg(long, value_name = "LOG")]
    log: Vec<PathBuf>,
    /// Assumed vehicle parameters, for the thesis's methods. Give it once for all runs, or once for
    /// each run [default: NAME.vehicle.toml beside NAME.truth.csv, else vehicle.toml].
    #[arg(long, value_name = "V.toml")]
    vehicle: Vec<PathBuf>,
    /// True vehicle parameters and noise levels, for the oracle. Give it once for all runs, or once
    /// for each run [default: NAME.oracle.toml beside NAME.truth.csv].
    #[arg(long, value_name = "ORACLE.toml", hide_short_help = true)]
    oracle: Vec<PathBuf>,
}

/// Arguments of `score`.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade score --truth drive.truth.csv drive.csv",
    after_long_help = "\
Each cell is compared with the truth at the same time. Both times count from the first frame of \
the log. The first and last 500 m of each run are not scored. Each row has the RMSE over all cells \
and over valid cells (neither a gear shift nor braking), the bias (estimate minus truth), the mean \
normalised squared error (NEES, near 1 if the sigmas are consistent), and the ratio of the RMSE to \
the oracle's. The last columns are the part of the cells that are marked as suspect, and the NEES \
of the others. The last rows are means over the runs.

Rows of each run:
  smoothed, lagged, live  the estimates in RUN.csv
  original                the thesis's filter (section 3), smoothed
  modified                the thesis's filter after its corrections of mass and bias (section 8)
  oracle, oracle_lagged,  this filter with the true vehicle parameters and noise levels: the best
  oracle_live             that better parameters and tuning could reach. The lagged and the live
                          grade are compared with its lagged and live grade, all others with its
                          smoothed grade.

The last five need the log. The thesis's methods also need the vehicle file, and the oracle needs an \
oracle file. `simulate` writes these files beside the truth, and `score` finds them there. Rows \
whose files are missing are left out. The keys of an oracle file are documented in \
docs/formats.md.

Examples:
  roadgrade score --truth sim/a1.truth.csv --truth sim/a2.truth.csv a1.csv a2.csv
  roadgrade score --truth a.csv --log a.log --vehicle a.toml --oracle true.toml run.csv"
)]
pub struct Args {
    /// True grade of the drive. Give it once for all runs, or once for each run in their order.
    #[arg(long, required = true, value_name = "TRUTH.csv")]
    truth: Vec<PathBuf>,
    #[command(flatten)]
    companions: Options,
    /// CSV file for the table [default: score.csv beside the first run].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Runs to score, as `estimate` wrote them.
    #[arg(required = true, value_name = "RUN.csv")]
    runs: Vec<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if a file cannot be read or used, or a run has no cell to compare.
pub fn run(args: &Args) -> Result<()> {
    let args = &Args {
        runs: of_kind(&args.runs, "run", Kind::Run)?,
        truth: of_kind(&args.truth, "truth file", Kind::Truth)?,
        ..args.clone()
    };
    check_counts(args)?;
    let out = args.out.clone().unwrap_or_else(|| {
        let folder = args.runs[0].parent().unwrap_or(Path::new(""));
        folder.join("score.csv")
    });
    args.check_output(&out)?;
    outputs::check_file(&out, &["csv"])?;
    let truths = args
        .truth
        .iter()
        .map(|path| truth::read(path))
        .collect::<Result<Vec<_>>>()?;
    let named = args.named();
    let bar = progress::count(args.runs.len() as u64, "runs");
    let judged: Vec<Result<Judged>> = (0..args.runs.len())
        .into_par_iter()
        .map(|index| {
            let of_run = index.min(truths.len() - 1);
            let files = Companions::of(named, index, &args.truth[of_run]);
            let judged = judge(&args.runs[index], &truths[of_run], &files);
            bar.inc(1);
            judged
        })
        .collect();
    bar.finish_and_clear();
    // The error of the first run in order is reported, so that threads do not decide which.
    let judged = judged.into_iter().collect::<Result<Vec<_>>>()?;
    print_notes(&args.runs, &judged);
    let mut rows: Vec<ScoreRow> = judged.into_iter().flat_map(|judged| judged.rows).collect();
    if args.runs.len() > 1 {
        rows.extend(mean(&rows));
    }
    write_csv(&out, rows.iter().map(ScoreRow::rounded))?;
    if args.json {
        print(&format!("{}\n", score::json(&rows)))?;
    } else {
        print(&format!("{}\n", score::table(&rows)))?;
    }
    note(format_args!("{}", on_one_line(&out)));
    Ok(())
}

impl Args {
    fn named(&self) -> NamedFiles<'_> {
        NamedFiles {
            log: &self.companions.log,
            vehicle: &self.companions.vehicle,
            oracle: &self.companions.oracle,
        }
    }

    /// Checks that the table is none of the inputs, those beside the truth included.
    fn check_output(&self, out: &Path) -> Result<()> {
        let companions: Vec<Companions> = (0..self.runs.len())
            .map(|index| {
                let of_run = index.min(self.truth.len() - 1);
                Companions::of(self.named(), index, &self.truth[of_run])
            })
            .collect();
        let inputs = self.truth.iter().chain(&self.runs).map(PathBuf::as_path);
        let inputs = inputs.chain(companions.iter().flat_map(Companions::files));
        outputs::check(inputs, [out])
    }
}

/// Returns a usage error unless each kind of file is named once for all runs or once for each.
fn check_counts(args: &Args) -> Result<()> {
    let runs = args.runs.len();
    let options = &args.companions;
    for (option, count) in [
        ("truth", args.truth.len()),
        ("log", options.log.len()),
        ("vehicle", options.vehicle.len()),
        ("oracle", options.oracle.len()),
    ] {
        if count > 1 && count != runs {
            let problem = format!(
                "{count} times --{option} for {runs} runs; expected one for all runs, or one \
                 for each run"
            );
            return Err(Error::Usage(problem));
        }
    }
    Ok(())
}

/// Prints each note on stderr, once for all the runs that have it.
fn print_notes(runs: &[PathBuf], judged: &[Judged]) {
    let mut notes: Vec<(&str, Vec<&Path>)> = Vec::new();
    for (run, judged) in runs.iter().zip(judged) {
        for note in &judged.notes {
            match notes.iter_mut().find(|(known, _)| known == note) {
                Some((_, of)) => of.push(run),
                None => notes.push((note, vec![run])),
            }
        }
    }
    for (words, of) in notes {
        match of.as_slice() {
            [run] => note(format_args!("{}: {words}", on_one_line(run))),
            of => note(format_args!(
                "{} and {} more: {words}",
                on_one_line(of[0]),
                of.len() - 1
            )),
        }
    }
}
