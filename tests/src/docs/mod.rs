//! Tables of the documentation that come from the code or from commands.
//!
//! A page has a marked block for each:
//!
//! ```text
//! <!-- begin: NAME (command or source) -->
//! …
//! <!-- end: NAME -->
//! ```

mod budget_tables;
mod code_tables;
mod counter_table;
mod diagnosis_table;
mod measured_tables;
mod outside_tables;
mod pipe_table;
mod road_tables;
mod sensitivity_tables;

use crate::image::root;
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use std::fs;
use std::path::PathBuf;

/// What it costs to make a block again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cost {
    /// Nothing: it is read from the code or a committed file.
    Nothing,
    /// Some seconds of a release build.
    Seconds,
    /// A minute of a release build.
    Minute,
}

/// A block that a page has.
struct Block {
    /// Path of the page from the root of the repository.
    page: &'static str,
    /// Name in the markers.
    name: &'static str,
    /// Source of its content, for the reader.
    from: &'static str,
    cost: Cost,
    /// Makes its content; `None` where measured data are needed and absent.
    make: fn() -> Result<Option<String>>,
}

const TUNING: &str = "from estimator-core/src/tuning/mod.rs";
const EFFECTS: &str = "from estimator-core/src/effect";
const SIGNALS: &str = "from estimator-core/src/signal and estimator-core/dbc";
const COUNTERS: &str = "from estimator-core/src/counters.rs";
const MECHANISMS: &str = "cargo run -p cross-tests --example sensitivity -- mechanisms";
const OUTSIDE: &str = "cargo run -p cross-tests --example accuracy";
const BUDGETS: &str = "cargo run -p cross-tests --release --example budgets";
const MOTORWAY: &str = "roadgrade simulate, estimate, score: motorway.toml";
const DEMO: &str = "roadgrade demo";
const ACCURACY: &str = "roadgrade study accuracy";
const FLEET: &str = "roadgrade study fleet";
const SENSORS: &str = "roadgrade study sensors";
const THESIS: &str = "roadgrade study modified";
const E4: &str = "roadgrade study e4";
const BRIDGES: &str = "roadgrade study bridges";
const ZTBUS: &str = "roadgrade study ztbus";
const TRACK: &str = "roadgrade study track";
const DIAGNOSE: &str = "roadgrade diagnose";

macro_rules! blocks {
    ($($page:literal $name:literal $from:ident $cost:ident $make:expr;)*) => {
        /// Every block.
        const BLOCKS: &[Block] = &[$(Block {
            page: $page,
            name: $name,
            from: $from,
            cost: Cost::$cost,
            make: || $make,
        }),*];
    };
}

blocks! {
    "docs/tuning.md" "estimation" TUNING Nothing code_tables::tuning("estimation");
    "docs/tuning.md" "measurement_noise" TUNING Nothing code_tables::tuning("measurement_noise");
    "docs/tuning.md" "prior" TUNING Nothing code_tables::tuning("prior");
    "docs/tuning.md" "hold_times" TUNING Nothing code_tables::tuning("hold_times");
    "docs/tuning.md" "detection" TUNING Nothing code_tables::tuning("detection");
    "docs/theory.md" "mechanisms" MECHANISMS Nothing sensitivity_tables::without_mechanisms();
    "docs/theory/effects.md" "effects" EFFECTS Nothing code_tables::effects();
    "docs/theory/effects.md" "parameters of effects" EFFECTS Nothing code_tables::effect_parameters();
    "docs/formats.md" "effect ranges" EFFECTS Nothing code_tables::effect_ranges();
    "docs/interfaces.md" "signals" SIGNALS Nothing code_tables::signals();
    "docs/interfaces.md" "counters" COUNTERS Nothing counter_table::counters();
    "docs/interfaces.md" "sensors" SENSORS Minute measured_tables::sensors();
    "docs/interfaces.md" "budgets" BUDGETS Nothing budget_tables::of_the_estimator();
    "docs/results.md" "budgets" BUDGETS Nothing budget_tables::with_effects();
    "docs/results.md" "budgets of fixed point" BUDGETS Nothing budget_tables::fixed_point();
    "docs/results.md" "other simulators" OUTSIDE Nothing outside_tables::of_simulators();
    "docs/results.md" "motorway" MOTORWAY Seconds measured_tables::motorway();
    "docs/results.md" "demo" DEMO Seconds measured_tables::demo();
    "docs/results.md" "accuracy" ACCURACY Minute measured_tables::accuracy();
    "docs/results.md" "fleet" FLEET Minute measured_tables::fleet();
    "docs/results.md" "thesis" THESIS Minute measured_tables::thesis();
    "docs/results.md" "e4 runs" E4 Minute road_tables::e4_runs();
    "docs/results.md" "e4 convergence" E4 Minute road_tables::e4_convergence();
    "docs/results.md" "bridges" BRIDGES Minute road_tables::bridges();
    "docs/results.md" "bridges bus" BRIDGES Minute road_tables::bridges_bus();
    "docs/results.md" "bus" ZTBUS Minute measured_tables::bus();
    "docs/results.md" "track" TRACK Seconds road_tables::track();
    "docs/results.md" "track effects" TRACK Seconds road_tables::track_effects();
    "docs/results.md" "bus diagnosis" DIAGNOSE Seconds diagnosis_table::bus();
    "README.md" "measured vehicles" OUTSIDE Nothing outside_tables::of_vehicles();
    "README.md" "accuracy" ACCURACY Minute measured_tables::accuracy_in_short();
}

/// A page with its blocks made again.
#[derive(Clone, Debug)]
pub struct Page {
    /// Its file.
    pub path: PathBuf,
    /// Its text as committed.
    pub committed: String,
    /// Its text with the blocks made again.
    pub current: String,
}

/// Pages with their blocks made again, and the names of the blocks that could not be made.
#[derive(Clone, Debug, Default)]
pub struct Pages {
    /// Every page that has a block.
    pub pages: Vec<Page>,
    /// Blocks whose measured data are absent.
    pub skipped: Vec<&'static str>,
}

/// Makes every block again that costs no more than this.
///
/// # Errors
/// A page cannot be read or lacks a block, or a command fails.
pub fn pages(most: Cost) -> Result<Pages> {
    let mut pages = Pages::default();
    for block in BLOCKS {
        let path = root().join(block.page);
        let at = match pages.pages.iter().position(|page| page.path == path) {
            Some(at) => at,
            None => {
                let committed = fs::read_to_string(&path).map_err(Error::io(&path))?;
                pages.pages.push(Page {
                    path: path.clone(),
                    current: committed.clone(),
                    committed,
                });
                pages.pages.len() - 1
            }
        };
        let page = &mut pages.pages[at].current;
        let content = if block.cost <= most {
            (block.make)()?
        } else {
            None
        };
        // A block that is not made again must exist, too.
        let filled = fill(page, block, content.as_deref());
        *page = filled.map_err(|problem| Error::content(&path, problem))?;
        if content.is_none() && block.cost <= most {
            pages.skipped.push(block.name);
        }
    }
    Ok(pages)
}

impl Page {
    /// Writes the page if a block changed.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self) -> Result<()> {
        if self.current == self.committed {
            return Ok(());
        }
        write_whole(&self.path, |file| file.write_all(self.current.as_bytes()))
    }
}

/// Replaces the content of a block; `None` leaves it unchanged.
fn fill(page: &str, block: &Block, content: Option<&str>) -> std::result::Result<String, String> {
    let Block { name, from, .. } = block;
    let begin = format!("<!-- begin: {name} ({from}) -->\n");
    let end = format!("<!-- end: {name} -->");
    let missing = |mark: &str| format!("no `{}`", mark.trim_end());
    let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (old, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    let content = match content {
        Some(content) => format!("\n{}\n\n", content.trim()),
        None => old.to_owned(),
    };
    Ok(format!("{before}{begin}{content}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: Block = Block {
        page: "",
        name: "a",
        from: "b",
        cost: Cost::Nothing,
        make: || Ok(None),
    };

    #[test]
    fn a_block_is_replaced_and_nothing_else() {
        let page = "x\n<!-- begin: a (b) -->\nold\n<!-- end: a -->\ny\n";
        let new = "x\n<!-- begin: a (b) -->\n\nnew\n\n<!-- end: a -->\ny\n";
        assert_eq!(fill(page, &BLOCK, Some("new\n")).unwrap(), new);
        assert_eq!(fill(page, &BLOCK, None).unwrap(), page);
    }

    #[test]
    fn a_page_without_the_block_is_an_error() {
        let problem = fill("text", &BLOCK, Some("new")).unwrap_err();
        assert_eq!(problem, "no `<!-- begin: a (b) -->`");
    }
}
