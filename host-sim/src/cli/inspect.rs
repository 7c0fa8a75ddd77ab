//! `roadgrade inspect`.

use super::log_files::{self, LogFiles};
use super::log_options::LogOptions;
use super::{log_notes, outputs};
use crate::error::{Error, Result};
use crate::files::output::write_whole;
use crate::inspect::census::Census;
use crate::inspect::census_of;
use crate::inspect::channels::{channels_text, propose_channels};
use crate::inspect::columns::proposed_columns;
use crate::inspect::dbc_census::{DbcCounter, DbcSignalCount};
use crate::inspect::needs::{Need, needs};
use crate::inspect::proposal::{Proposal, propose, to_toml};
use crate::inspect::text::{columns_text, dbc_text, text};
use crate::source::column_count::{ColumnCount, count_columns};
use crate::source::log::{Log, is_foreign_table};
use crate::source::log_kind::LogKind;
use crate::source::log_report::LogReport;
use crate::source::own_signals::dbc::Dbc;
use crate::source::read_options::ReadOptions;
use crate::source::signal_table::TIME;
use crate::terminal::print::{alert, print};
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
        roadgrade inspect --dbc car.dbc --out signals.toml drive.log\n  \
        roadgrade inspect --out columns.toml table.csv\n  \
        roadgrade inspect --signals signals.toml measurement.mf4\n  \
        roadgrade inspect --json table.csv | jq '.needs[] | select(.presence != \"present\")'"
)]
pub struct Args {
    /// A log of frames (candump, ASC, TRC, BLF, MDF 4, pcap, BUSMASTER, CSV of SavvyCAN, python-can or
    /// CANedge, NMEA 2000 as text), decoded signals (MDF 4) or a signal table (.csv); plain, gzip or zstd; -
    /// is standard input.
    log: PathBuf,
    #[command(flatten)]
    reading: LogOptions,
    /// List every message and identifier. By default, only the most frequent of those that the
    /// estimator does not read are listed.
    #[arg(long)]
    all: bool,
    /// Write the proposed mapping of own messages (with --dbc) or of the columns of a table.
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
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
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<TableInspection>,
    /// Proposed mapping of the channels of a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    mapping: Option<ChannelInspection>,
}

/// What a table has besides our columns.
#[derive(Serialize)]
struct TableInspection {
    columns: Vec<ColumnCount>,
    /// Proposed mapping, as a `COLUMNS.toml`.
    columns_toml: String,
}

impl TableInspection {
    fn of(log: &Path, census: &Census) -> Result<Self> {
        let columns = count_columns(log)?;
        Ok(Self {
            columns_toml: proposed_columns(&columns, census),
            columns,
        })
    }

    fn text(&self) -> String {
        format!(
            "{}\nA COLUMNS.toml to start from, for --columns: check each column, above all its unit and \
             its sign.\n\n{}",
            columns_text(&self.columns),
            self.columns_toml
        )
    }
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
            let proposal = propose_channels(census);
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
    fn of(counter: DbcCounter, census: &Census) -> Self {
        let signals = counter.finish();
        let proposal = propose(&signals, census);
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
    let options = args.reading.inspect_options()?;
    if !args.log.is_dir() || args.json || args.out.is_some() {
        return of_log(args, &log_files::one(&args.log, &options)?, &options);
    }
    let logs = LogFiles::of(std::slice::from_ref(&args.log), &options)?;
    for (number, log) in logs.paths.iter().enumerate() {
        if number > 0 {
            print("\n")?;
        }
        of_log(args, log, &options)?;
    }
    Ok(())
}

fn of_log(args: &Args, log: &Path, options: &ReadOptions) -> Result<()> {
    if let Some(out) = &args.out {
        outputs::check_file(out, &["toml"])?;
        let inputs = args.reading.files().chain([log]);
        outputs::check(inputs, [out.as_path()])?;
    }
    let bar = progress::bytes(log.metadata().map_or(0, |file| file.len()));
    let dbc = args.reading.own().dbc().map(Dbc::read).transpose()?;
    if let (Some(dbc), None) = (&dbc, &options.signals) {
        log_notes::note_left_out(dbc.path(), dbc.left_out());
    }
    let mut counter = dbc.as_ref().map(DbcCounter::new);
    let progress = |read| bar.set_position(read);
    let read = census_of(log, options, counter.as_mut(), progress);
    bar.finish_and_clear();
    let (kind, census, report) = match read {
        Ok(read) => read,
        Err(error) => return of_foreign_table(args, log, options, error),
    };
    log_notes::note_report(log, &report);
    let dbc = counter.map(|counter| DbcInspection::of(counter, &census));
    let is_foreign = kind == LogKind::SignalTable && !report.ignored_columns.is_empty();
    let table = (is_foreign && log.is_file()).then(|| TableInspection::of(log, &census));
    let table = table.transpose()?;
    let mapping = ChannelInspection::of(&census, options);
    let proposed = dbc.as_ref().map(|dbc| &dbc.signals_toml);
    let proposed = proposed.or(mapping.as_ref().map(|mapping| &mapping.signals_toml));
    write_proposal(
        args,
        log,
        proposed.or(table.as_ref().map(|table| &table.columns_toml)),
    )?;
    let kind = kind.to_string();
    let needs = needs(&census);
    if !args.json {
        let head = format!("{}: {kind}", log.display());
        let interfaces = &report.interfaces;
        let dbc = dbc.as_ref().map(DbcInspection::text).unwrap_or_default();
        let table = table
            .as_ref()
            .map(TableInspection::text)
            .unwrap_or_default();
        let mapping = mapping.as_ref().map(ChannelInspection::text);
        let channels = channels_text(&census.channels) + &mapping.unwrap_or_default();
        let text = text(&head, &census, interfaces, &needs, args.all);
        return print(&(text + &dbc + &table + &channels));
    }
    let inspection = Inspection {
        log,
        kind,
        census: &census,
        needs: &needs,
        dbc,
        table,
        mapping,
        report: &report,
    };
    let json = serde_json::to_string_pretty(&inspection).map_err(|e| Error::io(log)(e.into()))?;
    print(&(json + "\n"))
}

/// Shows the columns of a table whose header is not understood, and what they may be.
///
/// # Errors
/// Returns `error`, with which the log was refused, if it is none, or if no column may be ours.
fn of_foreign_table(args: &Args, log: &Path, options: &ReadOptions, error: Error) -> Result<()> {
    let is_header = || is_foreign_table(log) && Log::open(log, options).is_err();
    if options.columns.is_some() || matches!(error, Error::Usage(_)) || !is_header() {
        return Err(error);
    }
    let table = match TableInspection::of(log, &Census::default()) {
        Ok(table) if table.columns_toml.contains("[columns.time_s]") => table,
        _ => return Err(error),
    };
    // With our time, it is a table of ours with a misspelt name.
    let is_ours = table.columns.iter().any(|column| column.column == TIME);
    if is_ours && args.out.is_none() {
        return Err(error);
    }
    write_proposal(args, log, Some(&table.columns_toml))?;
    alert(format_args!("warning: {error}"));
    if args.json {
        let json = serde_json::json!({ "log": log, "table": table });
        return print(&format!("{json:#}\n"));
    }
    print(&table.text())
}

/// Writes the proposed mapping.
fn write_proposal(args: &Args, log: &Path, proposed: Option<&String>) -> Result<()> {
    let Some(out) = &args.out else {
        return Ok(());
    };
    let Some(proposed) = proposed.filter(|text| text.contains("\n[")) else {
        let problem = "nothing to propose: no signal of a .dbc file (--dbc) and no column of a table fits one \
                       of ours that the log lacks";
        return Err(Error::content(log, problem));
    };
    write_whole(out, |file| file.write_all(proposed.as_bytes()))
}
