//! `roadgrade listen`: a live bus becomes a run.

use super::conclusion;
use crate::error::{Error, Result};
use crate::files::output::Staged;
use crate::files::run::Origin;
use crate::files::vehicle::VehicleFile;
use crate::live::{Ended, ListenRequest, Listening};
use crate::recorder::{self, LongRun, Summary};
use crate::terminal::print::print;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `listen`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
On a terminal a panel shows the grade with its sigma, what the estimate is worth now (mode), speed, bias and scale of the vehicle model, frames a second and events. Where output goes elsewhere, one line a second goes to stdout, and the summary of the end to stderr; with --json both are JSON, one object a line.

mode: valid, or what the vehicle model suffers from: shifting, braking, no-traction, crawling, joined by +; waiting before the first speed; silent when no frame has come for two seconds.

Ctrl-C (or SIGTERM) ends the drive: the run is smoothed as a whole and RUN.csv written, as `roadgrade estimate` does. A second Ctrl-C ends at once and writes nothing.

The kernel is asked only for the messages that an estimate needs, whoever sends them, and stamps them. Frames that it had to drop because they were not read fast enough are counted as lost. An interface that goes down or vanishes is waited for. Setting the computer's clock does no harm.

--log FILE writes what was received, in candump's layout and with the times that the estimate used: `roadgrade estimate` of FILE gives the very same cells.

--log-time goes with `roadgrade replay --log-time`: frames have the time of the log that is replayed, so that the cells are those of the file, to the last digit and at any speed; the drive ends with the log.

--publish sends the estimate ten times a second, and each finished cell, on the first interface; the layout is estimator-core/dbc/grade.dbc. No address is claimed (J1939-81): give one that is free. With --address 254 the identifiers are those of the file, for tools that know nothing of J1939 addresses.

Try it without a truck:
  ip link add dev vcan0 type vcan && ip link set vcan0 up
  roadgrade simulate --scenario host-sim/scenarios/demo.toml --out sim
  roadgrade replay --can vcan0 sim/a1.log &
  roadgrade listen --can vcan0 --vehicle sim/a1.vehicle.toml --out run.csv
All of it in a few seconds:
  roadgrade replay --can vcan0 --log-time --speed max sim/a1.log &
  roadgrade listen --can vcan0 --log-time --vehicle sim/a1.vehicle.toml --out run.csv")]
pub struct Args {
    /// CAN interface; more than once for several buses of one vehicle.
    #[arg(long = "can", value_name = "INTERFACE", required = true)]
    interfaces: Vec<String>,
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// Where the run goes when the drive ends.
    #[arg(long, value_name = "RUN.csv")]
    out: Option<PathBuf>,
    /// What the vehicle's last drive left, and what this one leaves for the next.
    #[arg(long, value_name = "FILE")]
    kept: Option<PathBuf>,
    /// Where the frames received go, as a candump log.
    #[arg(long, value_name = "FILE.log")]
    log: Option<PathBuf>,
    /// Send the estimate on the first interface.
    #[arg(long)]
    publish: bool,
    /// J1939 address to send from.
    #[arg(long, value_name = "N", default_value_t = 128, requires = "publish",
          value_parser = clap::value_parser!(u8).range(0..=254))]
    address: u8,
    /// Frames have the time of the log that `replay --log-time` sends.
    #[arg(long)]
    log_time: bool,
    /// End the drive when no frame has come for so long.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    end_after_silence: Option<Duration>,
    /// JSON instead of lines, panel and table.
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let positive = |seconds: &f64| *seconds > 0.0;
    let seconds = text.parse().ok().filter(positive);
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "expected a number of seconds above 0".to_owned())
}

impl Args {
    fn request(&self) -> ListenRequest<'_> {
        ListenRequest {
            interfaces: &self.interfaces,
            vehicle_file: &self.vehicle,
            kept: self.kept.as_deref(),
            log: self.log.as_deref(),
            address: self.publish.then_some(self.address),
            log_time: self.log_time,
            end_after_silence: self.end_after_silence,
            json: self.json,
        }
    }
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    check(args)?;
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let mut listening = Listening::begin(args.request(), &vehicle)?;
    // What fails on the way ends the drive, and is reported when the drive is written.
    let ended = listening.run();
    let Ended {
        view,
        shown,
        run,
        log,
        takes_stdout,
    } = listening.finish();
    let logged = log.and_then(|log| log.map_or(Ok(()), Staged::commit));
    if let (Ok(()), Some(log)) = (&logged, &args.log) {
        eprintln!("wrote {}", log.display());
    }
    let mut run = run?;
    conclude(args, &vehicle, &mut run)?;
    let summary = Summary::new(&mut run)?;
    let told = if args.json {
        let last = json!({ "summary": summary, "interfaces": view.interfaces });
        print(&format!("{last}\n"))
    } else if takes_stdout {
        eprintln!("{}", summary.table());
        Ok(())
    } else {
        print(&format!("{}\n", summary.table()))
    };
    ended.and(shown).and(logged).and(told)
}

/// Refuses interfaces that make no sense together.
fn check(args: &Args) -> Result<()> {
    let names = &args.interfaces;
    let is_repeated = |(index, name): (usize, &String)| names[..index].contains(name);
    let problem = if names.iter().enumerate().any(is_repeated) {
        "an interface is named twice; expected each once"
    } else if args.log_time && names.len() > 1 {
        "--log-time with several interfaces; expected one, which all of the log is replayed to"
    } else {
        return Ok(());
    };
    Err(Error::Usage(problem.to_owned()))
}

/// Writes what the drive left. What was driven for hours is not thrown away because something was
/// missing: that is said.
fn conclude(args: &Args, vehicle: &VehicleFile, run: &mut LongRun) -> Result<()> {
    if let Some(problem) = recorder::missing(vehicle, run) {
        let bus = args.interfaces.join(", ");
        if run.rows.count() == 0 && args.out.is_some() {
            return Err(Error::content(Path::new(&bus), problem));
        }
        eprintln!("roadgrade: {bus}: {problem}");
    }
    let origin = Origin {
        vehicle: Some(vehicle.name.clone()),
        day: None,
    };
    conclusion::write(run, args.out.as_deref(), &origin, args.kept.as_deref())
}
