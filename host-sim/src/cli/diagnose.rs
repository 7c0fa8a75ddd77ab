//! `roadgrade diagnose`.

use super::log_files::LogFiles;
use super::log_options::LogOptions;
use super::tuning_option::TuningOption;
use super::{log_notes, outputs};
use crate::diagnose::{Diagnosis, Request, diagnose, report};
use crate::error::{Result, on_one_line};
use crate::files::vehicle::VehicleFile;
use crate::terminal::print::{note, print};
use crate::terminal::progress;
use crate::terminal::table::text_table;
use estimator_core::Signal;
use std::path::PathBuf;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade diagnose --vehicle V.toml --out found mon.log tue.log --holdout wed.log",
    after_long_help = "The command tests each effect of the catalogue. It predicts how the effect would change the \
    reported GNSS altitudes, and compares that with the usual errors of GNSS, wind and road. An \
    effect is adopted if the evidence for it is strong and the held-out drives do not contradict \
    it. The report also names effects that these drives cannot separate from an adopted one, and \
    the data that would separate them. A residual that depends clearly on time, place or a signal, \
    and that no effect explains, is reported as unexplained.\n\n\
    Drives in both directions, at different speeds and loads, are worth more than many similar \
    drives.\n\n\
    Examples:\n  \
    roadgrade diagnose --vehicle vehicle.toml --out found mon.log tue.log wed.log --holdout thu.log\n  \
    roadgrade diagnose --vehicle vehicle.toml --out found --reference map.csv *.log"
)]
pub struct Args {
    /// Vehicle parameters as currently assumed.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// Folder for report.json, vehicle.toml and report.html.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Reference grade: a map that `fuse` wrote.
    #[arg(long, value_name = "MAP.csv")]
    reference: Option<PathBuf>,
    /// Signal that is evidence beside the altitudes, and a judge of before and after:
    /// longitudinal_acceleration_mps2. The estimates do not see it.
    #[arg(long, value_name = "SIGNAL", value_parser = reference_signal, hide_short_help = true)]
    reference_signal: Option<Signal>,
    /// Folder of SRTM tiles (N47E008.hgt): before and after are told against terrain, too.
    #[arg(long, value_name = "DIR", hide_short_help = true)]
    terrain: Option<PathBuf>,
    /// Logs for validation only. They are not fitted. The errors before and after are computed on
    /// them. Default: the last log, if there are three or more.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    holdout: Vec<PathBuf>,
    #[command(flatten)]
    tuning: TuningOption,
    #[command(flatten)]
    reading: LogOptions,
    /// Print report.json instead of tables.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Drives of one vehicle: logs of frames (candump, ASC, TRC, BLF, MDF 4, CSV of other programs),
    /// decoded signals (MDF 4) or signal tables.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

impl Args {
    fn check_outputs(&self, written: &[PathBuf]) -> Result<()> {
        let logs = self.logs.iter().chain(&self.holdout).map(PathBuf::as_path);
        let others = [&*self.vehicle]
            .into_iter()
            .chain(self.reference.as_deref());
        outputs::check(
            logs.chain(others)
                .chain(self.tuning.file())
                .chain(self.reading.files()),
            written.iter().map(PathBuf::as_path),
        )
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    args.check_outputs(&report::FILES.map(|name| args.out.join(name)))?;
    let options = args.reading.read_options()?;
    let logs = LogFiles::of(&args.logs, &options)?;
    let holdout = LogFiles::of(&args.holdout, &options)?;
    let request = Request {
        vehicle: VehicleFile::read(&args.vehicle)?,
        logs: logs.paths.clone(),
        held_out: holdout.paths.clone(),
        reference: args.reference.clone(),
        terrain: args.terrain.clone(),
        accelerometer: args.reference_signal.is_some(),
        tuning: args.tuning.read()?,
        options,
    };
    let wait = progress::spinner("reading and evaluating drives");
    let found = diagnose(&request)?;
    wait.finish_and_clear();
    for (log, report) in &found.logs {
        log_notes::note_report(log, report);
    }
    args.check_outputs(&report::files(&found, &args.out))?;
    let page = report::write(&found, &args.out)?;
    if args.json {
        print(&format!("{:#}\n", report::to_json(&found)))?;
    } else {
        print(&tables(&found))?;
    }
    note(format_args!("page to open: {}", on_one_line(&page)));
    Ok(())
}

/// Parses a signal that can be a reference.
fn reference_signal(name: &str) -> std::result::Result<Signal, String> {
    let known = Signal::LongitudinalAcceleration;
    if name == known.column() {
        Ok(known)
    } else {
        Err(format!("expected {}", known.column()))
    }
}

fn tables(found: &Diagnosis) -> String {
    let rows: Vec<Vec<String>> = found
        .candidates
        .iter()
        .map(|case| {
            vec![
                case.name.to_owned(),
                format!("{:.4}", case.amount),
                format!("{:.4}", case.sigma),
                case.unit.to_owned(),
                format!("{:+.1}", case.evidence),
                report::three_digits(found.before.rmse_percent),
                report::three_digits(case.after.rmse_percent),
            ]
        })
        .collect();
    let header = [
        "effect", "amount", "sigma", "unit", "evidence", "before %", "alone %",
    ];
    format!(
        "{}\n{}\n",
        text_table(&header, &rows, 1),
        report::in_a_sentence(found)
    )
}
