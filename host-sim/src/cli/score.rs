//! `roadgrade score`.

use crate::error::{Error, Result};
use crate::files::csv::write_csv;
use crate::files::truth;
use crate::score::companions::{Companions, NamedFiles};
use crate::score::judged::{Judged, judge};
use crate::score::{self, ScoreRow, mean};
use crate::terminal::print::print;
use crate::terminal::progress;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The options that name them; each once for all runs, or once for each.
#[derive(Debug, clap::Args)]
struct Options {
    /// The log that the run was estimated from; needed for the rows beside it. Once for all runs,
    /// or one for each [default: NAME.log or NAME.log.gz beside NAME.truth.csv].
    #[arg(long, value_name = "LOG")]
    log: Vec<PathBuf>,
    /// The vehicle as it was believed, for the thesis's methods; once or one for each run [default:
    /// NAME.vehicle.toml beside NAME.truth.csv, else vehicle.toml].
    #[arg(long, value_name = "V.toml")]
    vehicle: Vec<PathBuf>,
    /// The true vehicle and noise, for the oracle; once or one for each run [default:
    /// NAME.oracle.toml beside NAME.truth.csv].
    #[arg(long, value_name = "ORACLE.toml")]
    oracle: Vec<PathBuf>,
}

/// Arguments of `score`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Cells are compared with the truth at their time, both counted from the log's first frame. The first \
and last 500 m of each run are left out. In each row: RMSE over all cells and over valid cells \
(neither a gear shift nor braking), bias (estimate minus truth), the mean normalised squared error \
(NEES, near 1 if the sigmas are honest), and the RMSE over the oracle's. Last the means over runs.

Rows of each run:
  smoothed, lagged, live  what RUN.csv holds
  original                the thesis's filter (section 3), smoothed
  modified                the thesis's filter after its corrections of mass and bias (section 8)
  oracle, oracle_lagged,  our filter, told the true vehicle and how large every noise is (not what \
it came
  oracle_live             to): what better knowledge could gain. The lagged and the live grade are \
set
                          against its lagged and live, all else against its smoothed.

The last five need the log; the thesis's methods also the vehicle file, the oracle an oracle file. \
`simulate` writes all of them beside the truth, where they are found; what is not there is left \
out. Keys of an oracle file: docs/formats.md, or any that `simulate` writes.

Examples:
  roadgrade score --truth sim/a1.truth.csv --truth sim/a2.truth.csv a1.csv a2.csv
  roadgrade score --truth a.csv --log a.log --vehicle a.toml --oracle true.toml run.csv")]
pub struct Args {
    /// The truth of the drive; once for all runs, or repeated, one for each run in their order.
    #[arg(long, required = true, value_name = "TRUTH.csv")]
    truth: Vec<PathBuf>,
    #[command(flatten)]
    companions: Options,
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
///
/// # Errors
/// A file that cannot be read or used; a run without a cell to compare.
pub fn run(args: &Args) -> Result<()> {
    check_counts(args)?;
    let truths = args
        .truth
        .iter()
        .map(|path| truth::read(path))
        .collect::<Result<Vec<_>>>()?;
    let named = NamedFiles {
        log: &args.companions.log,
        vehicle: &args.companions.vehicle,
        oracle: &args.companions.oracle,
    };
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
    // The first run that fails is told, whichever was done first.
    let judged = judged.into_iter().collect::<Result<Vec<_>>>()?;
    tell(&args.runs, &judged);
    let mut rows: Vec<ScoreRow> = judged.into_iter().flat_map(|judged| judged.rows).collect();
    if args.runs.len() > 1 {
        rows.extend(mean(&rows));
    }
    let out = args.out.clone().unwrap_or_else(|| {
        let folder = args.runs[0].parent().unwrap_or(Path::new(""));
        folder.join("score.csv")
    });
    write_csv(&out, rows.iter().map(ScoreRow::rounded))?;
    if args.json {
        print(&format!("{}\n", score::json(&rows)))?;
    } else {
        print(&format!("{}\n", score::table(&rows)))?;
    }
    eprintln!("{}", out.display());
    Ok(())
}

/// Refuses wrong usage: each kind of file is named once for all runs or once for each.
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
                "{count} times --{option} for {runs} runs; expected one for all, or one for each \
                 run"
            );
            return Err(Error::Usage(problem));
        }
    }
    Ok(())
}

/// Says on stderr what has to be said, once for all runs of which it is true.
fn tell(runs: &[PathBuf], judged: &[Judged]) {
    let mut told: Vec<(&str, Vec<&Path>)> = Vec::new();
    for (run, judged) in runs.iter().zip(judged) {
        for note in &judged.notes {
            match told.iter_mut().find(|(known, _)| known == note) {
                Some((_, of)) => of.push(run),
                None => told.push((note, vec![run])),
            }
        }
    }
    for (note, of) in told {
        match of.as_slice() {
            [run] => eprintln!("{}: {note}", run.display()),
            of => eprintln!("{} and {} more: {note}", of[0].display(), of.len() - 1),
        }
    }
}
