//! `roadgrade inspect`.

use super::inspect_text::text;
use crate::error::Result;
use crate::source::candump::CandumpReader;
use crate::source::census::{BusCounter, Census, TableCounter};
use crate::source::needs::{Need, needs};
use crate::source::signal_table::SignalTableReader;
use crate::source::{LogKind, kind_of};
use crate::terminal::print::print;
use crate::terminal::progress;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Frames between two moves of the progress bar.
const BAR_STEP: u64 = 1 << 16;

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
    let (kind, census) = match kind_of(&args.log)? {
        LogKind::Candump => ("candump log", count_frames(&args.log)?),
        LogKind::SignalTable => ("signal table", count_rows(&args.log)?),
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
    let json = serde_json::to_string_pretty(&inspection)
        .map_err(|e| crate::error::Error::io(&args.log)(e.into()))?;
    print(&(json + "\n"))
}

fn count_frames(path: &Path) -> Result<Census> {
    let mut log = CandumpReader::open(path)?;
    let bar = progress::bytes(log.file().bytes_total());
    let mut counter = BusCounter::default();
    let mut frames = 0_u64;
    while let Some(frame) = log.next_frame()? {
        counter.add(&frame);
        frames += 1;
        if frames.is_multiple_of(BAR_STEP) {
            bar.set_position(log.file().bytes_read());
        }
    }
    bar.finish_and_clear();
    Ok(counter.finish(log.skipped()))
}

fn count_rows(path: &Path) -> Result<Census> {
    let mut table = SignalTableReader::open(path)?;
    let bar = progress::bytes(table.file().bytes_total());
    let mut counter = TableCounter::new(table.signals());
    let mut rows = 0_u64;
    while let Some(row) = table.next_row()? {
        counter.add(&row);
        rows += 1;
        if rows.is_multiple_of(BAR_STEP) {
            bar.set_position(table.file().bytes_read());
        }
    }
    bar.finish_and_clear();
    Ok(counter.finish())
}
