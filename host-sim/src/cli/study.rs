//! `roadgrade study`: tables and figures, computed.

use super::outputs;
use crate::error::{Error, Result};
use crate::report::page::{Page, Section};
use crate::study::{STUDIES, Setting, Study, StudyOutcome};
use crate::terminal::print::{note, print};
use crate::terminal::table::text_table;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

/// Name that selects all studies.
const ALL: &str = "all";

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(
        std::iter::once(clap::builder::PossibleValue::new(ALL).help("every study")).chain(
            STUDIES
                .iter()
                .map(|study| clap::builder::PossibleValue::new(study.name).help(study.about)),
        ),
    )
}

/// Arguments of `study`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Name of the study.
    #[arg(value_parser = names())]
    name: String,
    /// Folder for the tables (CSV), the figures (SVG, and CSV of their data) and report.html.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Folder with the measured data: ztbus/*.csv, srtm/*.hgt, i3/Trip*.csv.gz, e4/road.csv and peterbilt/.
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    data: PathBuf,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 2011)]
    seed: u64,
    /// Print the tables as JSON: an object for each, with its columns and rows.
    #[arg(long)]
    json: bool,
}

impl Args {
    /// Returns the files of the measured data.
    fn inputs(&self) -> Vec<PathBuf> {
        let folders = ["ztbus", "srtm", "i3", "e4", "peterbilt"].map(|name| self.data.join(name));
        let entries = folders.iter().filter_map(|folder| folder.read_dir().ok());
        let paths = entries.flatten().flatten().map(|entry| entry.path());
        paths.collect()
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let setting = Setting {
        data: args.data.clone(),
        seed: args.seed,
    };
    let wanted = |study: &&Study| args.name == ALL || args.name == study.name;
    let mut sections = Vec::new();
    for study in STUDIES.iter().filter(wanted) {
        note(format_args!("{}: {}", study.name, study.about));
        match (study.run)(&setting)? {
            StudyOutcome::Done(section) => {
                if !args.json {
                    print_tables(&section)?;
                }
                sections.push(section);
            }
            StudyOutcome::Skipped(why) if args.name == ALL => note(format_args!("skipped: {why}")),
            StudyOutcome::Skipped(why) => return Err(Error::content(&args.data, why)),
        }
    }
    let one = STUDIES.iter().find(|study| study.name == args.name);
    let page = Page {
        title: one.map_or_else(
            || "The thesis's tables and figures, computed".to_owned(),
            |of| format!("Study {}: {}", of.name, of.about),
        ),
        lead: "P. Ståhl, \"Performance analysis of a grade estimation method by means of \
               simulation\" (Stockholm 2011), and measured data. The tables list the \
               thesis's numbers beside ours."
            .to_owned(),
        sections,
    };
    let inputs = args.inputs();
    outputs::check(
        inputs.iter().map(PathBuf::as_path),
        page.files(&args.out).iter().map(PathBuf::as_path),
    )?;
    let file = page.write(&args.out)?;
    if args.json {
        return print(&format!("{}\n", tables_as_json(&page.sections)));
    }
    print(&format!("page to open: {}\n", file.display()))
}

fn tables_as_json(sections: &[Section]) -> serde_json::Value {
    let tables = sections.iter().flat_map(|section| &section.tables);
    let tables = tables.map(|table| {
        serde_json::json!({
            "name": table.name,
            "caption": table.caption,
            "columns": table.header,
            "rows": table.rows,
        })
    });
    tables.collect()
}

fn print_tables(section: &Section) -> Result<()> {
    for table in &section.tables {
        let text = text_table(&table.header, &table.rows, 1);
        print(&format!("\n{}\n{text}\n", table.caption))?;
    }
    print("\n")
}
