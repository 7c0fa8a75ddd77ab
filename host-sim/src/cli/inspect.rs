//! `roadgrade inspect`.

use crate::error::{Error, Result};
use crate::inspect::census::Census;
use crate::inspect::census_of;
use crate::inspect::needs::{Need, needs};
use crate::inspect::text::text;
use crate::source::log_kind::LogKind;
use crate::terminal::print::print;
use crate::terminal::progress;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
#[command(
    long_about = "Show what is on a bus, and what an estimate would miss.\n\n\
        Lists the messages with their senders and rates, the range of every signal that the \
        estimator reads, and what an estimate needs of all that: whether it is there, and what \
        happens without it. Reads the whole log, in constant memory.",
    after_long_help = "Examples:\n  \
        roadgrade inspect drive.log\n  \
        roadgrade inspect --all drive.log.gz\n  \
        roadgrade inspect --json table.csv | jq '.needs[] | select(.presence != \"present\")'"
)]
pub struct Args {
    /// A candump log (`candump -l`, or as candump prints it with `-t a`), or a signal table
    /// (.csv); plain or gzip.
    log: PathBuf,
    /// List every message and identifier; without it, only the most frequent of those that the
    /// estimator does not read.
    #[arg(long)]
    all: bool,
    /// Print everything as one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Inspection<'a> {
    log: &'a Path,
    kind: &'static str,
    #[serde(flatten)]
    census: &'a Census,
    needs: &'a [Need],
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let bar = progress::bytes(args.log.metadata().map_or(0, |file| file.len()));
    let (kind, census) = census_of(&args.log, |read| bar.set_position(read))?;
    bar.finish_and_clear();
    let kind = match kind {
        LogKind::Candump => "candump log",
        LogKind::SignalTable => "signal table",
    };
    let needs = needs(&census);
    if !args.json {
        let head = format!("{}: {kind}", args.log.display());
        return print(&text(&head, &census, &needs, args.all));
    }
    let inspection = Inspection {
        log: &args.log,
        kind,
        census: &census,
        needs: &needs,
    };
    let json =
        serde_json::to_string_pretty(&inspection).map_err(|e| Error::io(&args.log)(e.into()))?;
    print(&(json + "\n"))
}
