//! `roadgrade inspect`.

use super::log_notes;
use super::log_options::LogOptions;
use crate::error::{Error, Result};
use crate::inspect::census::Census;
use crate::inspect::census_of;
use crate::inspect::channels::{channels_text, propose_channels};
use crate::inspect::dbc_census::{DbcCounter, DbcSignalCount};
use crate::inspect::needs::{Need, needs};
use crate::inspect::proposal::{Proposal, propose, to_toml};
use crate::inspect::text::{dbc_text, text};
use crate::source::log_report::LogReport;
use crate::source::own_signals::dbc::Dbc;
use crate::source::read_options::ReadOptions;
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
        roadgrade inspect --dbc car.dbc drive.log\n  \
        roadgrade inspect --signals signals.toml measurement.mf4\n  \
        roadgrade inspect --json table.csv | jq '.needs[] | select(.presence != \"present\")'"
)]
pub struct Args {
    /// A log of frames (candump, ASC, TRC, BLF, MDF 4, CSV of SavvyCAN or python-can), decoded signals (MDF
    /// 4) or a signal table (.csv); plain, gzip or zstd; - is standard input.
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

/// Above a proposal.
const TO_START: &str =
    "A SIGNALS.toml to start from: check each signal, above all its unit and its sign.";

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
    #[serde(skip_serializing_if = "Option::is_none")]
    dbc: Option<DbcInspection>,
    /// Proposed mapping of the channels of a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    mapping: Option<ChannelInspection>,
}

/// A proposed mapping of channels that are not ours yet.
#[derive(Serialize)]
struct ChannelInspection {
    proposal: Vec<Proposal>,
    /// The same as a `SIGNALS.toml`.
    signals_toml: String,
}

impl ChannelInspection {
    /// Proposes a mapping for a log with channels, unless the user has one.
    fn of(census: &Census, options: &ReadOptions) -> Option<Self> {
        let is_asked = !census.channels.is_empty() && options.channels.is_none();
        is_asked.then(|| {
            let proposal = propose_channels(&census.channels);
            Self {
                signals_toml: to_toml(&proposal),
                proposal,
            }
        })
    }

    fn text(&self) -> String {
        format!("\n{TO_START}\n\n{}", self.signals_toml)
    }
}

/// What the log has of a `.dbc` file.
#[derive(Serialize)]
struct DbcInspection {
    signals: Vec<DbcSignalCount>,
    /// Proposed mapping.
    proposal: Vec<Proposal>,
    /// The same as a `SIGNALS.toml`.
    signals_toml: String,
}

impl DbcInspection {
    fn of(counter: DbcCounter) -> Self {
        let signals = counter.finish();
        let proposal = propose(&signals);
        Self {
            signals_toml: to_toml(&proposal),
            signals,
            proposal,
        }
    }

    fn text(&self) -> String {
        format!(
            "{}\n{TO_START}\n\n{}",
            dbc_text(&self.signals),
            self.signals_toml
        )
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let bar = progress::bytes(args.log.metadata().map_or(0, |file| file.len()));
    let options = args.reading.inspect_options()?;
    let dbc = args.reading.own().dbc().map(Dbc::read).transpose()?;
    if let (Some(dbc), None) = (&dbc, &options.signals) {
        log_notes::note_left_out(dbc.path(), dbc.left_out());
    }
    let mut counter = dbc.as_ref().map(DbcCounter::new);
    let progress = |read| bar.set_position(read);
    let (kind, census, report) = census_of(&args.log, &options, counter.as_mut(), progress)?;
    bar.finish_and_clear();
    log_notes::note_report(&args.log, &report);
    let dbc = counter.map(DbcInspection::of);
    let kind = kind.to_string();
    let needs = needs(&census);
    let mapping = ChannelInspection::of(&census, &options);
    if !args.json {
        let head = format!("{}: {kind}", args.log.display());
        let interfaces = &report.interfaces;
        let dbc = dbc.as_ref().map(DbcInspection::text).unwrap_or_default();
        let mapping = mapping.as_ref().map(ChannelInspection::text);
        let channels = channels_text(&census.channels) + &mapping.unwrap_or_default();
        let text = text(&head, &census, interfaces, &needs, args.all);
        return print(&(text + &dbc + &channels));
    }
    let inspection = Inspection {
        log: &args.log,
        kind,
        census: &census,
        needs: &needs,
        dbc,
        mapping,
        report: &report,
    };
    let json =
        serde_json::to_string_pretty(&inspection).map_err(|e| Error::io(&args.log)(e.into()))?;
    print(&(json + "\n"))
}
