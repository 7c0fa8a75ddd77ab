//! `roadgrade listen`: estimates a run from a live bus.

use super::log_options::OwnOptions;
use super::memory_option::MemoryOption;
use super::tuning_option::TuningOption;
use super::{conclusion, outputs};
use crate::error::{Error, Result, on_one_line};
use crate::files::output::Staged;
use crate::files::run::Origin;
use crate::files::vehicle::VehicleFile;
use crate::live::{EndedDrive, ListenRequest, Listening};
use crate::map::open_packed_map;
use crate::recorder::{self, LongRun, RunSummary};
use crate::terminal::print::{alert, note, print};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `listen`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade listen --can can0 --vehicle V.toml --out run.csv",
    after_long_help = "\
On a terminal a panel shows the grade with its sigma, the mode, speed, bias and scale of the vehicle model, frames per second and events. If stdout is not a terminal, one line per second goes to stdout and the final summary to stderr. With --json both are JSON, one object per line.

The mode is valid, or the conditions in which the vehicle model does not hold: shifting, braking, no-traction, crawling, joined by +. It is waiting before the first speed, and silent after two seconds without a frame.

Ctrl-C (or SIGTERM) ends the drive. The command then smooths the whole run and writes RUN.csv, as `roadgrade estimate` does. A second Ctrl-C ends the program at once and writes nothing.

The kernel filters and time-stamps the frames. It passes only the messages that an estimate needs, from any source address. Frames that the kernel drops because they are not read fast enough count as lost. If an interface goes down or disappears, the command waits until it is back. Setting the system clock does not affect the estimate.

--log FILE writes the received frames as a candump log, with the time stamps that the estimate used. `roadgrade estimate` of FILE gives the same cells.

--log-time belongs to `roadgrade replay --log-time`. Frames then have the time stamps of the replayed log. At any replay speed the cells equal those of the file to the last digit. The drive ends with the log.

--publish sends the estimate ten times per second, each finished cell, and once per second the status (GradeStatus: what disagrees, gross mass), on the first interface. The layout is estimator-core/dbc/grade.dbc. The command does not claim an address (J1939-81), so choose a free one. With --map it also sends PCC1 (the grade, the next grade and its distance) and GradeAhead, the grade of the next 2 km. With --address 254 the identifiers are exactly those of the file, for tools without J1939 addressing.

--map MAP.grade combines the live grade with that of a map, as `roadgrade pack` writes it, and shows the road ahead: its climb over 2 km, the mean grades of each 250 m, and where another way leaves it. Lagged and smoothed grades never contain the map.

--memory FILE is the road memory of the vehicle: the roads that it has driven, as `estimate --memory` keeps it. It is written once a minute, and at the end of the drive.

Try it without a truck:
  ip link add dev vcan0 type vcan && ip link set vcan0 up
  roadgrade simulate --scenario host-sim/scenarios/demo.toml --out sim
  roadgrade replay --can vcan0 sim/a1.log &
  roadgrade listen --can vcan0 --vehicle sim/a1.vehicle.toml --out run.csv
The same in a few seconds:
  roadgrade replay --can vcan0 --log-time --speed max sim/a1.log &
  roadgrade listen --can vcan0 --log-time --vehicle sim/a1.vehicle.toml --out run.csv"
)]
pub struct Args {
    /// CAN interface. Repeat the option for several buses of one vehicle.
    #[arg(long = "can", value_name = "INTERFACE", required = true)]
    interfaces: Vec<String>,
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// File for the run, written when the drive ends.
    #[arg(long, value_name = "RUN.csv")]
    out: Option<PathBuf>,
    /// Persistent state of the vehicle: read before the drive, written after it.
    #[arg(long, value_name = "FILE")]
    kept: Option<PathBuf>,
    #[command(flatten)]
    tuning: TuningOption,
    #[command(flatten)]
    own: OwnOptions,
    /// Packed map: the live grade is combined with the map's, and the road ahead is shown.
    #[arg(long, value_name = "MAP.grade")]
    map: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryOption,
    /// File for the received frames, as a candump log.
    #[arg(long, value_name = "FILE.log", hide_short_help = true)]
    log: Option<PathBuf>,
    /// Send the estimate on the first interface.
    #[arg(long)]
    publish: bool,
    /// J1939 source address of the published frames.
    #[arg(long, value_name = "N", default_value_t = 128, requires = "publish",
          value_parser = clap::value_parser!(u8).range(0..=254), hide_short_help = true)]
    address: u8,
    /// Use the time stamps that `replay --log-time` sends.
    #[arg(long, hide_short_help = true)]
    log_time: bool,
    /// End the drive after this time without a frame.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, hide_short_help = true)]
    end_after_silence: Option<Duration>,
    /// Print JSON instead of lines, panel and table.
    #[arg(long, hide_short_help = true)]
    json: bool,
}

fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let positive = |seconds: &f64| *seconds > 0.0;
    let seconds = text.parse().ok().filter(positive);
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "expected a number of seconds greater than 0".to_owned())
}

impl Args {
    fn request(&self) -> Result<ListenRequest<'_>> {
        Ok(ListenRequest {
            interfaces: &self.interfaces,
            vehicle_file: &self.vehicle,
            state_file: self.kept.as_deref(),
            tuning: self.tuning.read()?,
            log: self.log.as_deref(),
            map: self.map.as_deref().map(open_packed_map).transpose()?,
            memory: self.memory.path().zip(self.memory.open()?),
            address: self.publish.then_some(self.address),
            log_time: self.log_time,
            end_after_silence: self.end_after_silence,
            own: self.own.bus_mapping()?,
            json: self.json,
        })
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    check(args)?;
    if let Some(out) = &args.out {
        outputs::check_file(out, &["csv", "parquet"])?;
    }
    args.memory.path().map_or(Ok(()), outputs::check_folder)?;
    let outputs = [&args.out, &args.log, &args.kept];
    let outputs = outputs.into_iter().filter_map(|path| path.as_deref());
    outputs::check(
        [&*args.vehicle]
            .into_iter()
            .chain(args.map.as_deref())
            .chain(args.tuning.file())
            .chain(args.own.files()),
        outputs.chain(args.memory.path()),
    )?;
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let mut listening = Listening::begin(args.request()?, &vehicle)?;
    // An error ends the drive. It is reported after the run is written.
    let ended = listening.run();
    let EndedDrive {
        view,
        shown,
        run,
        log,
        takes_stdout,
    } = listening.finish();
    let logged = log.and_then(|log| log.map_or(Ok(()), Staged::commit));
    if let (Ok(()), Some(log)) = (&logged, &args.log) {
        note(format_args!("wrote {}", on_one_line(log)));
    }
    let mut run = run?;
    conclude(args, &vehicle, &mut run)?;
    let summary = RunSummary::new(&mut run)?;
    let printed = if args.json {
        let last = json!({ "summary": summary, "interfaces": view.interfaces });
        print(&format!("{last}\n"))
    } else if takes_stdout {
        note(format_args!("{}", summary.table()));
        Ok(())
    } else {
        print(&format!("{}\n", summary.table()))
    };
    ended.and(shown).and(logged).and(printed)
}

/// Returns an error for interface options that contradict each other.
fn check(args: &Args) -> Result<()> {
    let names = &args.interfaces;
    let is_repeated = |(index, name): (usize, &String)| names[..index].contains(name);
    let problem = if names.iter().enumerate().any(is_repeated) {
        "an interface is named twice; name each interface once"
    } else if args.log_time && names.len() > 1 {
        "--log-time with several interfaces; expected one interface that receives the whole log"
    } else {
        return Ok(());
    };
    Err(Error::Usage(problem.to_owned()))
}

/// Writes the files of the drive. If an input was missing, it warns and still writes the run: a
/// drive of hours is worth keeping.
fn conclude(args: &Args, vehicle: &VehicleFile, run: &mut LongRun) -> Result<()> {
    conclusion::warn(&run.warnings);
    if let Some(problem) = recorder::missing(vehicle, run, &[]) {
        let bus = args.interfaces.join(", ");
        if run.rows.count() == 0 && args.out.is_some() {
            return Err(Error::content(Path::new(&bus), problem));
        }
        alert(format_args!("roadgrade: {bus}: {problem}"));
    }
    conclusion::note_replaced(&vehicle.model, run);
    let origin = Origin {
        vehicle: Some(vehicle.name.clone()),
        day: None,
        start_utc: run.start_utc.clone(),
    };
    let memory = args.memory.stage(run)?;
    conclusion::write(run, args.out.as_deref(), &origin, args.kept.as_deref())?;
    memory.map_or(Ok(()), Staged::commit)
}
