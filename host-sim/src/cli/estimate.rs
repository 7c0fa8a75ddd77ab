//! `roadgrade estimate`: one recorded drive becomes a run.

use super::conclusion;
use crate::error::{Error, Result};
use crate::files::run::{self, Origin};
use crate::files::vehicle::VehicleFile;
use crate::files::{data_set, kept};
use crate::recorder::{self, LongRun, Summary};
use crate::smooth::held_bytes;
use crate::terminal::print::print;
use crate::terminal::progress;
use estimator_core::{PersistentState, Scalar};
use std::path::{Path, PathBuf};
use std::time::Instant as Clock;

/// Arguments of `estimate`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Needed on the bus: wheel speed (CCVS1 or EBC2), engine torque (EEC1) and friction (EEC3), the gear \
(ETC2; or engine speed, from which it is told), GNSS altitude (129029, or VDS). `roadgrade inspect \
LOG` tells what a log has. In a signal table the same by the names of its columns.

RUN.csv has one row for each 2.5 m: grade in % (smoothed over the whole run, lagged by 500 m, \
live), each with its standard deviation, position, altitude, and what the vehicle model was found \
to be off by. RUN.parquet has the same columns, their units as metadata, and in the file's \
metadata vehicle, day and session (\"VEHICLE DAY\"), which `fuse` goes by.

--dataset DIR files runs by place and day: the tile is the degree of latitude and longitude (its \
south-western corner, as of elevation data) in which the run has its first position; a run is \
never cut. `fuse` takes such a folder, or one tile of it, and engines know the layout as Hive's.

--kept FILE is the vehicle's memory from one drive to the next, as its ECU would have it: what the model was found to be off by, and how noisy the sensors were, so that the first kilometres are better. Where there is no FILE yet, the drive begins as without. Estimate the drives once each, in the order in which they were driven. A FILE that is damaged, or that another vehicle or an edited V.toml left, is refused: then remove it, or give the vehicle another. Wind, cold tyres and a load that may have changed are allowed for; a drive with less than 5 km leaves FILE as it was.

A drive may be of any length: memory does not grow with it. What does, 100 kB for each kilometre, is in a temporary file (in TMPDIR) while it is estimated.")]
pub struct Args {
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// Where the run goes: Parquet if the name ends in .parquet, else CSV.
    #[arg(long, value_name = "RUN", required_unless_present = "dataset")]
    out: Option<PathBuf>,
    /// A data set that takes the run, as DIR/tile=N47E008/day=DAY/LOG.parquet.
    #[arg(long, value_name = "DIR", conflicts_with = "out", requires = "day")]
    dataset: Option<PathBuf>,
    /// The day of the drive: with the vehicle's name it names the session that a Parquet run
    /// belongs to.
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = data_set::check_day)]
    day: Option<String>,
    /// What the vehicle's last drive left, and what this one leaves for the next.
    #[arg(long, value_name = "FILE")]
    kept: Option<PathBuf>,
    /// Compute in double instead of single precision.
    #[arg(long)]
    double: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    /// candump log (either layout, also .gz), or signal table (.csv, also .csv.gz).
    log: PathBuf,
}

impl Args {
    fn run_path(&self, run: &mut LongRun, origin: &Origin) -> Result<PathBuf> {
        let (Some(folder), Some(day)) = (&self.dataset, &self.day) else {
            return Ok(self.out.clone().unwrap_or_default());
        };
        let name = data_set::run_name(&self.log);
        let path = data_set::run_path(folder, &mut run.rows, day, &name)?;
        // The same drive may be estimated again; two trucks may give their logs one name.
        if path.exists() && run::session(&path)? != origin.session() {
            let problem = "has a run of another vehicle; expected none, or this one's: \
                           give the log another name";
            return Err(Error::content(&path, problem));
        }
        Ok(path)
    }
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let started = Clock::now();
    let file = args.kept.as_deref();
    let last = match file {
        Some(file) => kept::read(file, &vehicle.model)?,
        None => None,
    };
    let last = last.as_ref();
    let mut run = if args.double {
        drive::<f64>(&vehicle, last, &args.log)?
    } else {
        drive::<f32>(&vehicle, last, &args.log)?
    };
    let seconds = started.elapsed().as_secs_f64();
    check(&args.log, &vehicle, &run)?;
    let origin = Origin {
        vehicle: Some(vehicle.name),
        day: args.day.clone(),
    };
    let out = args.run_path(&mut run, &origin)?;
    conclusion::write(&mut run, Some(&out), &origin, file)?;

    let summary = Summary::new(&mut run)?;
    if args.json {
        let json = serde_json::to_string(&summary).expect("numbers are JSON");
        print(&format!("{json}\n"))?;
    } else {
        print(&format!("{}\n", summary.table()))?;
    }
    let frames = run.counters.frames;
    if frames > 0 {
        eprintln!(
            "{frames} frames in {seconds:.2} s, {:.0} frames/s",
            frames as f64 / seconds
        );
    }
    eprintln!(
        "whole-run smoothing held {} kB",
        held_bytes(run.rows.count()) / 1000
    );
    Ok(())
}

/// Estimates one log, with a progress bar on long ones.
pub(super) fn drive<S: Scalar>(
    vehicle: &VehicleFile,
    last: Option<&PersistentState>,
    log: &Path,
) -> Result<LongRun> {
    let bar = progress::bytes(log.metadata().map_or(0, |file| file.len()));
    let progress = |read| bar.set_position(read);
    let run = recorder::estimate_log::<S>(&vehicle.model, last, log, progress);
    bar.finish_and_clear();
    run
}

/// Whether the log held what an estimate needs; if not, what is missing.
pub(super) fn check(log: &Path, vehicle: &VehicleFile, run: &LongRun) -> Result<()> {
    match recorder::missing(vehicle, run) {
        Some(problem) => Err(Error::content(log, problem)),
        None => Ok(()),
    }
}
