//! `roadgrade estimate`: estimates a run from a recorded drive.

use super::log_files;
use super::log_options::LogOptions;
use super::memory_option::MemoryOption;
use super::tuning_option::TuningOption;
use super::{conclusion, log_notes, outputs, run_page};
use crate::error::{Error, Result};
use crate::files::flash_image::RoadMemoryFile;
use crate::files::object_storage;
use crate::files::output::Staged;
use crate::files::run::{self, Origin};
use crate::files::vehicle::VehicleFile;
use crate::files::{data_set, kept};
use crate::map::open_packed_map;
use crate::recorder::{self, LongRun, Recorder, RunSummary};
use crate::source::read_options::ReadOptions;
use crate::terminal::print::{note, print};
use crate::terminal::progress;
use estimator_core::roadmap::PackedMap;
use estimator_core::{PersistentState, Scalar, Tuning};
use std::path::{Path, PathBuf};
use std::time::Instant as Clock;

/// Arguments of `estimate`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade estimate --vehicle V.toml --out run.csv drive.log",
    after_long_help = "\
Required signals: wheel speed (CCVS1 or EBC2), engine torque (EEC1) and friction (EEC3), the gear \
(ETC2, or engine speed, from which the estimator derives it), GNSS altitude (129029, or VDS). A \
signal table has the same signals as columns. `roadgrade inspect LOG` lists the signals of a log.

RUN.csv has one row per cell of 2.5 m: grade in % (smoothed over the whole run, lagged by 500 m, \
live), each with its standard deviation, position, altitude, the estimated bias and scale of the \
vehicle model, gross mass, and whether the signals agree there. RUN.parquet has the same columns, with their units as metadata. The metadata \
of the file has vehicle, day and session (\"VEHICLE DAY\"); `fuse` uses the session.

--dataset DIR stores runs by tile and day. The tile is the degree of latitude and longitude of \
the first position of the run. It is named by its south-western corner, as elevation data are. A \
run is never split. `fuse` accepts such a folder, or one tile of it. Query engines read the layout \
as Hive partitions.

--kept FILE is the persistent state of the vehicle, as an ECU would store it between drives. It holds the estimated model errors and sensor noise, so the first kilometres of the next drive are more accurate. If FILE does not exist, the drive starts from the defaults. Estimate each drive once, in the order in which the drives took place. A damaged FILE is refused, and so is a FILE of another vehicle or of an edited V.toml: remove it, or use another FILE. The prior of the next drive allows for changes of wind, tyre temperature and load. A drive shorter than 5 km does not change FILE.

--memory FILE is the road memory of the vehicle, as an ECU would keep it in flash: every road that it has driven, with grade, sigma and place. On a road that it knows, the live grade is combined with what it knows (and with --map); map_grade_percent is then the grade of both. Smoothed and lagged grades are not changed. After the drive FILE knows this one too. If FILE does not exist, it becomes an empty memory of --memory-bytes. If it is full, the road that is driven least and longest ago makes room. `export FILE --out RUN.csv` writes it as a run that `fuse` reads.

--innovations FILE.csv is what speed, altitude and slope said beside what the filter predicted of them, one row each, with the variances that the whole run implies. test_ratio is the squared innovation over its variance, one on average; weight is low where later measurements contradict. The columns are in docs/formats.md.

A drive may have any length. Memory use is constant. A temporary file (in TMPDIR) takes 140 kB per kilometre, 190 kB with --innovations."
)]
pub struct Args {
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// File for the run: Parquet if the name ends in .parquet, else CSV.
    #[arg(long, value_name = "RUN", required_unless_present = "dataset")]
    out: Option<PathBuf>,
    /// Data set folder for the run, as DIR/tile=N47E008/day=DAY/LOG.parquet.
    #[arg(
        long,
        value_name = "DIR",
        conflicts_with = "out",
        requires = "day",
        hide_short_help = true
    )]
    dataset: Option<PathBuf>,
    /// Day of the drive. Vehicle name and day together name the session of a Parquet run.
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = data_set::check_day, hide_short_help = true)]
    day: Option<String>,
    /// Page that draws the run: plan, profile, sigma.
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
    /// File for the innovations of the smoothing pass (CSV), for tuning and review: one row for each
    /// measurement.
    #[arg(long, value_name = "FILE.csv", hide_short_help = true)]
    innovations: Option<PathBuf>,
    /// Packed map, as `pack` writes it. The live grade is combined with its grade. Smoothed and lagged
    /// grades are not.
    #[arg(long, value_name = "MAP.grade")]
    map: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryOption,
    /// Persistent state of the vehicle: read before the drive, written after it.
    #[arg(long, value_name = "FILE")]
    kept: Option<PathBuf>,
    #[command(flatten)]
    tuning: TuningOption,
    #[command(flatten)]
    reading: LogOptions,
    /// Compute in double precision instead of single precision.
    #[arg(long, hide_short_help = true)]
    double: bool,
    /// Print the summary as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Log of frames (candump, ASC, TRC, BLF, MDF 4, pcap, BUSMASTER, CSV of SavvyCAN, python-can or
    /// CANedge, NMEA 2000 as text), decoded signals (MDF 4) or signal table (.csv); plain, gzip or zstd; -
    /// is standard input.
    log: PathBuf,
}

impl Args {
    fn check_outputs(&self, out: Option<&Path>) -> Result<()> {
        let inputs = [&*self.log, &self.vehicle];
        let inputs = inputs.into_iter().chain(self.tuning.file());
        let inputs = inputs.chain(self.reading.files());
        let inputs = inputs.chain(self.map.as_deref());
        let others = [
            self.kept.as_deref(),
            self.memory.path(),
            self.page.as_deref(),
            self.innovations.as_deref(),
        ];
        outputs::check(inputs, out.into_iter().chain(others.into_iter().flatten()))
    }

    /// Checks endings and folders of the outputs.
    fn check_names(&self) -> Result<()> {
        if let Some(out) = &self.out {
            outputs::check_file(out, &["csv", "parquet"])?;
        }
        if let Some(page) = &self.page {
            outputs::check_file(page, &["html", "htm"])?;
        }
        if let Some(innovations) = &self.innovations {
            outputs::check_file(innovations, &["csv"])?;
        }
        let kept = [self.kept.as_deref(), self.memory.path()];
        kept.into_iter()
            .flatten()
            .try_for_each(outputs::check_folder)
    }

    /// Opens what is known of the roads.
    fn additions(&self) -> Result<Additions> {
        let map = self.map.as_deref().map(open_packed_map).transpose()?;
        Ok(Additions {
            map,
            memory: self.memory.open()?,
            keeps_innovations: self.innovations.is_some(),
        })
    }

    /// Writes page and innovations to files that appear when they are committed.
    fn stage_reports(&self, run: &mut LongRun, summary: &RunSummary) -> Result<Vec<Staged>> {
        let mut staged = Vec::new();
        if let Some(path) = &self.page {
            staged.push(run_page::stage(path, &self.log, &mut run.rows, summary)?);
        }
        if let Some((path, innovations)) = self.innovations.as_ref().zip(run.innovations.as_mut()) {
            staged.push(innovations.stage(path)?);
        }
        Ok(staged)
    }

    fn run_path(&self, run: &mut LongRun, origin: &Origin) -> Result<PathBuf> {
        let (Some(folder), Some(day)) = (&self.dataset, &self.day) else {
            return Ok(self.out.clone().unwrap_or_default());
        };
        let name = data_set::run_name(&self.log);
        let path = data_set::run_path(folder, &mut run.rows, day, &name)?;
        object_storage::bring(&path)?;
        // The same drive may be estimated again, but logs of two trucks may have the same name.
        if path.exists() && run::session(&path)? != origin.session() {
            let problem = "already holds a run of another vehicle or day; give the log another \
                           name";
            return Err(Error::content(&path, problem));
        }
        Ok(path)
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    args.check_outputs(args.out.as_deref())?;
    args.check_names()?;
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let tuning = args.tuning.read()?;
    let options = args.reading.read_options()?;
    let log = &log_files::one(&args.log, &options)?;
    let started = Clock::now();
    let file = args.kept.as_deref();
    let last = match file {
        Some(file) => kept::read(file, &vehicle.model)?,
        None => None,
    };
    let last = last.as_ref();
    let additions = args.additions()?;
    let mut run = if args.double {
        drive::<f64>(&vehicle, &tuning, last, additions, log, &options)?
    } else {
        drive::<f32>(&vehicle, &tuning, last, additions, log, &options)?
    };
    let seconds = started.elapsed().as_secs_f64();
    log_notes::note_report(log, &run.log);
    conclusion::warn(&run.warnings);
    recorder::check_inputs(log, &vehicle, &run, &options)?;
    conclusion::note_replaced(&vehicle.model, &run);
    let origin = Origin {
        vehicle: Some(vehicle.name),
        day: args.day.clone(),
        start_utc: run.start_utc.clone(),
    };
    let out = args.run_path(&mut run, &origin)?;
    args.check_outputs(Some(&out))?;
    let mut others = Vec::from_iter(args.memory.stage(&run)?);
    let summary = RunSummary::new(&mut run)?;
    others.extend(args.stage_reports(&mut run, &summary)?);
    conclusion::write(&mut run, Some(&out), &origin, file)?;
    others.into_iter().try_for_each(Staged::commit)?;

    print_summary(args, &summary, run.counters.frames, seconds)
}

/// Prints the summary of the drive of so many frames, which took this time to estimate.
fn print_summary(args: &Args, summary: &RunSummary, frames: u64, seconds: f64) -> Result<()> {
    if args.json {
        let json = serde_json::to_string(summary).expect("numbers are JSON");
        print(&format!("{json}\n"))?;
    } else {
        print(&format!("{}\n", summary.table()))?;
    }
    if frames > 0 {
        note(format_args!(
            "{frames} frames in {seconds:.2} s, {:.0} frames/s",
            frames as f64 / seconds
        ));
    }
    Ok(())
}

/// What a drive has besides vehicle and log: what is known of the roads, and what is kept of it.
#[derive(Debug, Default)]
pub(super) struct Additions {
    map: Option<PackedMap<'static>>,
    memory: Option<RoadMemoryFile>,
    keeps_innovations: bool,
}

/// Estimates one log and shows its progress.
pub(super) fn drive<S: Scalar>(
    vehicle: &VehicleFile,
    tuning: &Tuning,
    last: Option<&PersistentState>,
    additions: Additions,
    log: &Path,
    options: &ReadOptions,
) -> Result<LongRun> {
    let mut recorder = Recorder::<S>::resume(&vehicle.model, tuning, last)
        .map_err(|e| Error::content(log, e.to_string()))?;
    if let Some(map) = additions.map {
        recorder.follow(map);
    }
    if let Some(memory) = additions.memory {
        recorder.remember(memory);
    }
    if additions.keeps_innovations {
        recorder.keep_innovations();
    }
    let bar = progress::bytes(log.metadata().map_or(0, |file| file.len()));
    let progress = |read| bar.set_position(read);
    let run = recorder::record_log(recorder, log, options, progress);
    bar.finish_and_clear();
    run
}
