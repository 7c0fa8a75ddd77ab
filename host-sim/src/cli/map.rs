//! `roadgrade map`: from logs of one vehicle to a grade map.

use super::log_options::LogOptions;
use super::tuning_option::TuningOption;
use super::{conclusion, estimate, identify, outputs};
use crate::error::{Error, Result, on_one_line};
use crate::files::data_set;
use crate::files::output::{Staged, stage_text};
use crate::files::run::{self, RunCell};
use crate::files::vehicle::VehicleFile;
use crate::identify::{Identified, Request, annotated};
use crate::map::pipeline::roads_of_runs::roads_of_runs;
use crate::map::{self, GradeMap, Network, SessionRun, read_network, stage_map_ways};
use crate::recorder::{self, RunSummary};
use crate::report::logs_page::{LogRun, LogsMap, logs_page};
use crate::source::read_options::ReadOptions;
use crate::terminal::print::{note, print};
use crate::terminal::progress;
use crate::terminal::table::text_table;
use estimator_core::Tuning;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Arguments of `map`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "DIR gets vehicle.toml (identified from the logs, unless --vehicle gives one), runs/LOG.csv for \
    each drive, map.csv, and index.html, a page with plan, profile, runs, what was assumed and what \
    was wrong with the input.\n\n\
    Without --road, the roads are the tracks of the runs: map.csv has the columns way and direction \
    if there is more than one. A log that cannot be estimated is named and left out.\n\n\
    Examples:\n  \
    roadgrade map --out out *.blf\n  \
    roadgrade map --out out --vehicle truck7.toml --road road.csv mon.log tue.log\n  \
    roadgrade map --out out --join part1.log part2.log"
)]
pub struct Args {
    /// Folder for the results.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Vehicle parameters. Default: identified from the logs.
    #[arg(long, value_name = "V.toml")]
    vehicle: Option<PathBuf>,
    /// What the vehicle is like, where it is identified: a class, or another vehicle file.
    #[arg(long, value_name = "CLASS|V.toml", conflicts_with = "vehicle")]
    like: Option<String>,
    /// Road or network, as `fuse` takes it. Default: the tracks of the runs.
    #[arg(long, value_name = "ROAD.csv|NET.geojson")]
    road: Option<PathBuf>,
    /// The logs are consecutive parts of one drive, in this order.
    #[arg(long)]
    join: bool,
    #[command(flatten)]
    reading: LogOptions,
    #[command(flatten)]
    tuning: TuningOption,
    /// Print the summary of each run as JSON.
    #[arg(long)]
    json: bool,
    /// Logs of one vehicle, each a drive.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

/// One drive: its logs and the name of its run.
struct Drive {
    name: String,
    logs: Vec<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let drives = drives(args);
    check_outputs(args, &drives)?;
    let tuning = args.tuning.read()?;
    let road = args.road.as_deref().map(read_network).transpose()?;
    let (vehicle, identified) = vehicle(args, &tuning)?;
    let (runs, left_out) = estimate_all(&drives, &vehicle, &tuning, &args.reading.read_options()?)?;
    let cells: Vec<Vec<RunCell>> = runs
        .iter()
        .map(|of| of.rows.iter().map(RunCell::from).collect())
        .collect();
    let no_road = || {
        let problem = "no run has positions: expected GNSS positions (NMEA 2000 129025 or 129029)";
        Error::content(&args.logs[0], problem)
    };
    let road = road.or_else(|| roads_of_runs(&cells)).ok_or_else(no_road)?;
    let fused = fuse(&road, &runs, &vehicle.name);
    if fused.is_empty() {
        let problem = "no cell of the road is covered; expected runs on it, in its direction";
        return Err(Error::content(&args.logs[0], problem));
    }
    let map = LogsMap {
        network: &road,
        ways: &fused,
        runs: &runs,
        vehicle: &vehicle.name,
        identified: identified.as_ref(),
        left_out: &left_out,
    };
    let page = logs_page(&map);
    let mut staged: Vec<Staged> = Vec::new();
    let text = identified
        .as_ref()
        .map_or_else(|| vehicle.to_toml(), annotated::text);
    staged.push(stage_text(&args.out.join("vehicle.toml"), &text)?);
    staged.push(stage_map_ways(&args.out.join("map.csv"), &fused)?);
    staged.push(page.stage_alone(&args.out.join("index.html"))?);
    for of in &runs {
        run::write(&run_path(&args.out, &of.name), &of.rows)?;
    }
    for file in staged {
        file.commit()?;
    }
    conclude(args, &runs)
}

fn drives(args: &Args) -> Vec<Drive> {
    if args.join {
        return vec![Drive {
            name: data_set::run_name(&args.logs[0]),
            logs: args.logs.clone(),
        }];
    }
    let mut taken = BTreeSet::new();
    let drive = |log: &PathBuf| {
        let plain = data_set::run_name(log);
        // Logs of two folders may have the same name.
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        let mut names = std::iter::once(plain.clone()).chain(numbered);
        let name = names.find(|name| taken.insert(name.clone()));
        Drive {
            name: name.unwrap_or(plain),
            logs: vec![log.clone()],
        }
    };
    args.logs.iter().map(drive).collect()
}

fn run_path(folder: &Path, name: &str) -> PathBuf {
    folder.join("runs").join(format!("{name}.csv"))
}

fn check_outputs(args: &Args, drives: &[Drive]) -> Result<()> {
    let like = args.like.as_deref().map(Path::new);
    let inputs = args.logs.iter().map(PathBuf::as_path);
    let inputs = inputs
        .chain(args.vehicle.as_deref())
        .chain(args.road.as_deref())
        .chain(like)
        .chain(args.tuning.file());
    let own = ["vehicle.toml", "map.csv", "index.html"].map(|name| args.out.join(name));
    let runs = drives.iter().map(|drive| run_path(&args.out, &drive.name));
    let written: Vec<PathBuf> = own.into_iter().chain(runs).collect();
    outputs::check(inputs, written.iter().map(PathBuf::as_path))
}

fn vehicle(args: &Args, tuning: &Tuning) -> Result<(VehicleFile, Option<Identified>)> {
    if let Some(path) = &args.vehicle {
        return Ok((VehicleFile::read(path)?, None));
    }
    let request = Request {
        logs: args.logs.clone(),
        like: args.like.as_deref().map(identify::like).transpose()?,
        tuning: tuning.clone(),
        options: args.reading.read_options()?,
    };
    let found = identify::shown(&request)?;
    note(format_args!(
        "the vehicle is identified as one like {}; vehicle.toml tells what was read, measured and \
         assumed",
        found.class
    ));
    Ok((found.vehicle.clone(), Some(found)))
}

/// Estimates all drives. Returns the runs, and for each drive that has none a line that says why.
fn estimate_all(
    drives: &[Drive],
    vehicle: &VehicleFile,
    tuning: &Tuning,
    options: &ReadOptions,
) -> Result<(Vec<LogRun>, Vec<String>)> {
    let bar = progress::count(drives.len() as u64, "drives");
    let results: Vec<Result<LogRun>> = drives
        .par_iter()
        .map(|drive| {
            let run = estimate_one(drive, vehicle, tuning, options);
            bar.inc(1);
            run
        })
        .collect();
    bar.finish_and_clear();
    let (mut runs, mut problems) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(run) => runs.push(run),
            Err(problem) => problems.push(problem),
        }
    }
    let words: Vec<String> = problems.iter().map(ToString::to_string).collect();
    if runs.is_empty() {
        return Err(problems.swap_remove(0));
    }
    for problem in &words {
        note(format_args!("warning: left out: {problem}"));
    }
    Ok((runs, words))
}

fn estimate_one(
    drive: &Drive,
    vehicle: &VehicleFile,
    tuning: &Tuning,
    options: &ReadOptions,
) -> Result<LogRun> {
    let mut run = recorder::estimate_logs::<f32>(&vehicle.model, tuning, &drive.logs, options)?;
    estimate::check(&drive.logs[0], vehicle, &run)?;
    let summary = RunSummary::new(&mut run)?;
    let run = run.in_memory()?;
    Ok(LogRun {
        name: drive.name.clone(),
        rows: run.rows,
        summary,
        warnings: run.warnings,
    })
}

fn fuse(road: &Network, runs: &[LogRun], vehicle: &str) -> Vec<map::WayRows> {
    let mut sums = GradeMap::new(road);
    for of in runs {
        // One vehicle: its parameters are common to all runs.
        sums.add_run(&SessionRun {
            session: Some(vehicle),
            rows: &of.rows,
        });
    }
    sums.close_session(vehicle);
    sums.fused().ways
}

fn conclude(args: &Args, runs: &[LogRun]) -> Result<()> {
    if args.json {
        let json: Vec<_> = runs
            .iter()
            .map(|of| serde_json::json!({ "run": of.name, "summary": of.summary }))
            .collect();
        let json = serde_json::to_string(&json).expect("numbers are JSON");
        print(&format!("{json}\n"))?;
    } else {
        let rows: Vec<Vec<String>> = runs.iter().map(LogRun::line).collect();
        print(&format!("{}\n", text_table(&LogRun::HEADER, &rows, 1)))?;
    }
    for of in runs {
        conclusion::warn(&of.warnings);
    }
    let file = |name: &str| on_one_line(&args.out.join(name)).to_string();
    note(format_args!("map: {}", file("map.csv")));
    note(format_args!("page to open: {}", file("index.html")));
    Ok(())
}
