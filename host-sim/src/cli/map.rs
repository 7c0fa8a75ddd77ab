//! `roadgrade map`: from logs of one vehicle to a grade map.

use super::like_option::LikeOption;
use super::log_files::LogFiles;
use super::log_options::LogOptions;
use super::tuning_option::TuningOption;
use super::{conclusion, identify, log_notes, outputs};
use crate::error::{Error, Result, on_one_line};
use crate::files::vehicle::VehicleFile;
use crate::logs_to_map::{Drive, Job, MadeMap, drives, files, make};
use crate::map::read_network;
use crate::report::logs_page::LogRun;
use crate::terminal::print::{alert, note, print};
use crate::terminal::progress;
use crate::terminal::table::text_table;
use std::path::{Path, PathBuf};

/// Arguments of `map`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade map --out out *.blf",
    after_long_help = "DIR gets vehicle.toml (identified from the logs, unless --vehicle gives one), runs/LOG.csv for \
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
    #[arg(long, value_name = "V.toml", conflicts_with = "like")]
    vehicle: Option<PathBuf>,
    #[command(flatten)]
    like: LikeOption,
    /// Road or network, as `fuse` takes it. Default: the tracks of the runs.
    #[arg(long, value_name = "ROAD.csv|NET.geojson|NET.osm.pbf")]
    road: Option<PathBuf>,
    /// The logs are consecutive parts of one drive, in this order.
    #[arg(long)]
    join: bool,
    /// Keep drives that are suspect over most of their length. By default, they are named and left
    /// out.
    #[arg(long, hide_short_help = true)]
    keep_suspect: bool,
    #[command(flatten)]
    reading: LogOptions,
    #[command(flatten)]
    tuning: TuningOption,
    /// Print the summary of each run as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Logs of one vehicle, each a drive.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    check_folder(&args.out)?;
    let options = args.reading.read_options()?;
    let logs = LogFiles::of(&args.logs, &options)?;
    let drives = drives(&logs.paths, args.join);
    check_outputs(args, &drives)?;
    let job = Job {
        drives,
        vehicle: args.vehicle.as_deref().map(VehicleFile::read).transpose()?,
        like: args.like.read()?,
        roads: args.road.as_deref().map(read_network).transpose()?,
        tuning: args.tuning.read()?,
        options,
        keep_suspect: args.keep_suspect,
    };
    let wait = progress::spinner("reading the logs");
    let made = make(job, |step| wait.set_message(step.to_owned()))?;
    made.write(&args.out)?;
    wait.finish_and_clear();
    tell(&made);
    conclude(args, &made)
}

/// Checks, before the work, that the folder of the results can be one.
fn check_folder(out: &Path) -> Result<()> {
    if out.exists() && !out.is_dir() {
        let problem = "is a file; expected a folder, which may not exist yet";
        return Err(Error::content(out, problem));
    }
    Ok(())
}

fn check_outputs(args: &Args, drives: &[Drive]) -> Result<()> {
    let inputs = args.logs.iter().map(PathBuf::as_path);
    let inputs = inputs
        .chain(args.vehicle.as_deref())
        .chain(args.road.as_deref())
        .chain(args.like.file())
        .chain(args.tuning.file())
        .chain(args.reading.files());
    let written = files(&args.out, drives);
    outputs::check(inputs, written.iter().map(PathBuf::as_path))
}

/// Says what was assumed, and what was wrong with the input.
fn tell(made: &MadeMap) {
    if let Some(found) = made.identified() {
        identify::tell_delays(found);
        identify::tell_unknown(found);
        note(format_args!(
            "the vehicle is identified as one like {}; vehicle.toml says what was read, measured \
             and assumed",
            found.class
        ));
    }
    for problem in &made.left_out {
        alert(format_args!("warning: left out: {problem}"));
    }
    conclusion::warn(&made.warnings);
    for run in &made.runs {
        for (log, report) in &run.reports {
            log_notes::note_report(log, report);
        }
        conclusion::warn_of(&run.name, &run.warnings);
    }
}

fn conclude(args: &Args, made: &MadeMap) -> Result<()> {
    if args.json {
        print(&format!("{}\n", made.to_json()))?;
    } else {
        let rows: Vec<Vec<String>> = made.runs.iter().map(LogRun::line).collect();
        print(&format!("{}\n", text_table(&LogRun::HEADER, &rows, 1)))?;
    }
    let file = |name: &str| on_one_line(&args.out.join(name));
    note(format_args!("map: {}", file("map.csv")));
    note(format_args!("page to open: {}", file("index.html")));
    Ok(())
}
