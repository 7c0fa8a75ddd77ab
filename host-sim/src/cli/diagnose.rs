//! `roadgrade diagnose`.

use crate::diagnose::{Diagnosis, Request, diagnose, report};
use crate::error::Result;
use crate::files::vehicle::VehicleFile;
use crate::terminal::print::print;
use crate::terminal::progress;
use crate::terminal::table::text_table;
use std::path::PathBuf;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each effect of the catalogue is judged by what it would have done to the altitudes that GNSS \
    told, weighed against the errors that GNSS, wind and road have anyway. One is adopted if the \
    evidence for it is strong and the drives held out do not speak against it; effects that these \
    drives cannot tell from it are named with it, and so is what would tell them apart. What no \
    effect explains but clearly depends on time, place or a signal is reported as unexplained.\n\n\
    Drives both ways over a road, at different speeds and loads, tell more than many alike.\n\n\
    Examples:\n  \
    roadgrade diagnose --vehicle vehicle.toml --out found mon.log tue.log wed.log --holdout thu.log\n  \
    roadgrade diagnose --vehicle vehicle.toml --out found --reference map.csv *.log"
)]
pub struct Args {
    /// The vehicle as it is believed.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// Folder for report.json, vehicle.toml and report.html.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Grade to judge by, as `fuse` writes it.
    #[arg(long, value_name = "MAP.csv")]
    reference: Option<PathBuf>,
    /// Logs that are not used to fit, on which before and after are judged. Without any, the last
    /// of three or more logs.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    holdout: Vec<PathBuf>,
    /// Print report.json instead of tables.
    #[arg(long)]
    json: bool,
    /// Drives of one vehicle: candump logs or signal tables.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let request = Request {
        vehicle: VehicleFile::read(&args.vehicle)?,
        logs: args.logs.clone(),
        held_out: args.holdout.clone(),
        reference: args.reference.clone(),
    };
    let wait = progress::spinner("reading and judging drives");
    let found = diagnose(&request)?;
    wait.finish_and_clear();
    let page = report::write(&found, &args.out)?;
    if args.json {
        print(&format!("{:#}\n", report::to_json(&found)))?;
    } else {
        print(&tables(&found))?;
    }
    eprintln!("page to open: {}", page.display());
    Ok(())
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
                format!("{:.3}", found.before.rmse_percent),
                format!("{:.3}", case.after.rmse_percent),
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
