//! Makes the tables of the documentation again, and shows what changed:
//!
//! ```text
//! cargo run -p cross-tests --release --example docs [-- --check | --write] [--all]
//! ```
//!
//! Without `--all` it leaves out the tables of `roadgrade study`, which take a minute.

use clap::Parser;
use cross_tests::docs::{Cost, pages};
use cross_tests::exit_code;
use cross_tests::image::root;
use host_sim::error::{Error, Result};
use host_sim::terminal::print::print;
use similar::TextDiff;
use std::process::ExitCode;

#[derive(Parser)]
struct Options {
    /// Fail if a table is not current.
    #[arg(long)]
    check: bool,
    /// Write the tables into the pages.
    #[arg(long, conflicts_with = "check")]
    write: bool,
    /// Make the tables of `roadgrade study`, too.
    #[arg(long)]
    all: bool,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<()> {
    let most = if options.all {
        Cost::Minute
    } else {
        Cost::Seconds
    };
    let made = pages(most)?;
    for block in &made.skipped {
        eprintln!("SKIPPED: the block {block}, whose measured data are absent");
    }
    let mut changed = Vec::new();
    for page in &made.pages {
        if page.current == page.committed {
            continue;
        }
        let name = page.path.strip_prefix(root()).unwrap_or(&page.path);
        let name = name.display().to_string();
        let diff = TextDiff::from_lines(&page.committed, &page.current);
        print(&diff.unified_diff().header(&name, &name).to_string())?;
        if options.write {
            page.write()?;
        }
        changed.push(name);
    }
    if options.check && !changed.is_empty() {
        let problem = format!("not current: {}", changed.join(", "));
        return Err(Error::content(&root(), problem));
    }
    Ok(())
}
