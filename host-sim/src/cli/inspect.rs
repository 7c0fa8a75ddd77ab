//! `roadgrade inspect`.

use super::damage;
use super::log_options::LogOptions;
use crate::error::{Error, Result};
use crate::inspect::census::Census;
use crate::inspect::census_of;
use crate::inspect::needs::{Need, needs};
use crate::inspect::text::text;
use crate::source::log_report::LogReport;
use crate::terminal::print::print;
use crate::terminal::progress;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Show which messages are in a log, and which inputs of an estimate are missing.\n\n\
        Lists the messages with their source addresses and rates, and the range of every signal that \
        the estimator reads. For each input of an estimate it reports whether the log has it, and \
        what its absence costs. Reads the whole log in constant memory.",
    after_long_help = "Examples:\n  \
        roadgrade inspect drive.log\n  \
        roadgrade inspect --all drive.log.gz\n  \
        roadgrade inspect --json table.csv | jq '.needs[] | select(.presence != \"present\")'"
)]
pub struct Args {
    /// A log of frames (candump, ASC, TRC, BLF, MDF 4, CSV of SavvyCAN or python-can) or a signal table
    /// (.csv); plain, gzip or zstd; - is standard input.
    log: PathBuf,
    #[command(flatten)]
    reading: LogOptions,
    /// List every message and identifier. By default, only the most frequent of those that the
    /// estimator does not read are listed.
    #[arg(long)]
    all: bool,
    /// Print everything as one JSON object.
    #[arg(long)]
    json: bool,
}

/// The JSON output.
#[derive(Serialize)]
struct Inspection<'a> {
    log: &'a Path,
    kind: String,
    #[serde(flatten)]
    census: &'a Census,
    needs: &'a [Need],
    #[serde(flatten)]
    report: &'a LogReport,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let bar = progress::bytes(args.log.metadata().map_or(0, |file| file.len()));
    let (kind, census, report) = census_of(&args.log, &args.reading.read_options(), |read| {
        bar.set_position(read);
    })?;
    bar.finish_and_clear();
    damage::note_log(&args.log, &report);
    let kind = kind.to_string();
    let needs = needs(&census);
    if !args.json {
        let head = format!("{}: {kind}", args.log.display());
        let interfaces = &report.interfaces;
        return print(&text(&head, &census, interfaces, &needs, args.all));
    }
    let inspection = Inspection {
        log: &args.log,
        kind,
        census: &census,
        needs: &needs,
        report: &report,
    };
    let json =
        serde_json::to_string_pretty(&inspection).map_err(|e| Error::io(&args.log)(e.into()))?;
    print(&(json + "\n"))
}
