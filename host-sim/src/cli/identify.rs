//! `roadgrade identify`.

use super::like_option::LikeOption;
use super::log_files::LogFiles;
use super::log_options::LogOptions;
use super::outputs;
use super::tuning_option::TuningOption;
use crate::error::Result;
use crate::files::output::write_whole;
use crate::identify::annotated::{self, comment};
use crate::identify::{Identified, Request, class, identify};
use crate::terminal::print::{alert, note, print};
use crate::terminal::progress;
use crate::terminal::table::text_table;
use std::path::PathBuf;

/// Arguments of `identify`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roadgrade identify --out V.toml mon.log tue.log", after_long_help = after_help())]
pub struct Args {
    /// Vehicle file to write.
    #[arg(long, value_name = "V.toml")]
    out: PathBuf,
    #[command(flatten)]
    like: LikeOption,
    #[command(flatten)]
    reading: LogOptions,
    #[command(flatten)]
    tuning: TuningOption,
    /// Print each value as JSON: key, value, sigma, origin (read, measured, assumed).
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Drives of one vehicle: logs of frames or signal tables. Two are better than one.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

fn after_help() -> String {
    let classes: Vec<String> = class::all()
        .iter()
        .map(|class| format!("  {:<9} {}", class.name, class.about))
        .collect();
    format!(
        "Each value of the file has a comment: read off the bus, measured with its standard \
         deviation, or assumed for the class. What these logs cannot tell is named, with the drive \
         that would show it.\n\nClasses:\n{}\n\nExample:\n  roadgrade identify --out vehicle.toml \
         mon.log tue.log",
        classes.join("\n")
    )
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let like = args.like.read()?;
    let inputs = args.logs.iter().map(PathBuf::as_path);
    let inputs = inputs.chain(args.like.file()).chain(args.tuning.file());
    let inputs = inputs.chain(args.reading.files());
    outputs::check(inputs, [&*args.out])?;
    outputs::check_file(&args.out, &["toml"])?;
    let options = args.reading.read_options()?;
    let logs = LogFiles::of(&args.logs, &options)?;
    let request = Request {
        logs: logs.paths.clone(),
        like,
        tuning: args.tuning.read()?,
        options,
    };
    let found = shown(&request)?;
    let text = annotated::text(&found);
    write_whole(&args.out, |out| out.write_all(text.as_bytes()))?;
    if args.json {
        let json = serde_json::to_string_pretty(&found.values).expect("numbers are JSON");
        return print(&format!("{json}\n"));
    }
    print(&table(&found))
}

/// Identifies, and shows the progress.
fn shown(request: &Request) -> Result<Identified> {
    let wait = progress::spinner("reading the logs");
    let found = identify(request, |step| wait.set_message(step.to_owned()))?;
    wait.finish_and_clear();
    for problem in &found.left_out {
        alert(format_args!("warning: left out: {problem}"));
    }
    tell_delays(&found);
    tell_unknown(&found);
    Ok(found)
}

/// Says what is late.
pub(super) fn tell_delays(found: &Identified) {
    for delay in &found.delays {
        note(delay.sentence());
    }
}

/// Says what cannot be known from the logs.
pub(super) fn tell_unknown(found: &Identified) {
    for unknown in &found.unknown {
        note(format_args!(
            "not known: {}. {}",
            unknown.what, unknown.advice
        ));
    }
}

fn table(found: &Identified) -> String {
    let rows: Vec<Vec<String>> = found
        .values
        .iter()
        .map(|value| {
            vec![
                value.key.clone(),
                comment(value),
                format!("{:.5}", value.value),
            ]
        })
        .collect();
    format!("{}\n", text_table(&["key", "from", "value"], &rows, 2))
}
