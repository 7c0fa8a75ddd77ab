//! `roadgrade columns`.

use crate::error::{Error, Result};
use crate::source::signal_range::{plausible_range, unit};
use crate::source::signal_source::{BuiltIn, SignalSource};
use crate::terminal::print::print;
use crate::terminal::table::text_table;
use estimator_core::Signal;
use serde::Serialize;
use std::path::Path;

/// Arguments of `columns`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A signal table has the column time_s (seconds), and any of these. An empty cell or NaN is missing. The \
same names are used in SIGNALS.toml and with --ignore. Values beyond the range are those of no vehicle, \
and most of them are not used.")]
pub struct Args {
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
}

/// A signal as a column.
#[derive(Serialize)]
struct Column {
    column: &'static str,
    unit: &'static str,
    least: f64,
    most: f64,
    sources: Vec<SignalSource>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let built_in = BuiltIn::read()
        .map_err(|error| Error::content(Path::new("built-in layouts"), error.to_string()))?;
    let columns: Vec<Column> = Signal::ALL
        .iter()
        .map(|signal| {
            let (least, most) = plausible_range(*signal);
            Column {
                column: signal.column(),
                unit: unit(*signal),
                least,
                most,
                sources: built_in.sources_of(*signal),
            }
        })
        .collect();
    if args.json {
        let json = serde_json::to_string_pretty(&columns).expect("numbers and texts are JSON");
        return print(&format!("{json}\n"));
    }
    let rows: Vec<Vec<String>> = columns.iter().map(row).collect();
    let header = ["column", "unit", "from bus", "least", "most"];
    print(&format!("{}\n", text_table(&header, &rows, 3)))
}

fn row(column: &Column) -> Vec<String> {
    let sources: Vec<String> = column.sources.iter().map(in_words).collect();
    vec![
        column.column.to_owned(),
        column.unit.to_owned(),
        if sources.is_empty() {
            "-".to_owned()
        } else {
            sources.join(", ")
        },
        column.least.to_string(),
        column.most.to_string(),
    ]
}

fn in_words(source: &SignalSource) -> String {
    let SignalSource {
        bus,
        message,
        pgn,
        spn,
    } = source;
    match spn {
        Some(spn) => format!("{bus} {message} {pgn} SPN {spn}"),
        None => format!("{bus} {message} {pgn}"),
    }
}
