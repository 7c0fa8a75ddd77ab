//! The cost of the estimator on each target and in each scalar type, in bytes and instructions.
//!
//! The emulator counts, so the counts do not depend on the host. A table of them is committed. A
//! count that grows fails the check.

use crate::drive::{drive, truck, truck_with_every_effect};
use crate::drive_map::drive_map;
use crate::emulator::{count, drive_file};
use crate::image::{IMAGE_PROFILE, Image, build, root};
use estimator_core::Model;
use host_sim::error::{Error, Result};
use host_sim::source::can_frame::TimedFrame;
use host_sim::terminal::table::text_table;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A board that images run on, and the scalar types of its images.
#[derive(Clone, Copy, Debug)]
pub struct BoardTarget {
    /// Name in QEMU.
    pub machine: &'static str,
    /// Target triple.
    pub target: &'static str,
    /// Scalar types, as named in `src/bin/budget.rs` and `src/bin/alone_*.rs`.
    pub scalars: &'static [&'static str],
}

/// All boards. The upper bounds are for the first.
pub const BOARDS: [BoardTarget; 2] = [CORTEX_M4F, CORTEX_M0];
/// Cortex-M4F.
pub const CORTEX_M4F: BoardTarget = BoardTarget {
    machine: "mps2-an386",
    target: "thumbv7em-none-eabihf",
    scalars: &["f32", "fixed"],
};

/// Cortex-M0, without a float unit. QEMU emulates a Cortex-M3 with the same memory instead.
pub const CORTEX_M0: BoardTarget = BoardTarget {
    machine: "mps2-an385",
    target: "thumbv6m-none-eabi",
    scalars: &["f32", "fixed"],
};

/// A row of the table.
#[derive(Clone, Copy, Debug)]
struct BudgetRow {
    name: &'static str,
    words: &'static str,
    /// Upper bound, for `f32` on a Cortex-M4F.
    bar: Option<u32>,
    /// Whether the check fails above the bound. Others are goals.
    is_limit: bool,
}

const fn figure(name: &'static str, words: &'static str, bar: Option<u32>) -> BudgetRow {
    BudgetRow {
        name,
        words,
        bar,
        is_limit: false,
    }
}

const fn limited(name: &'static str, words: &'static str, most: u32) -> BudgetRow {
    BudgetRow {
        is_limit: true,
        ..figure(name, words, Some(most))
    }
}

const FIGURES: [BudgetRow; 46] = [
    figure("flash_bytes", "flash of the estimator, bytes", Some(80_000)),
    figure("image_flash_bytes", "flash of its whole image", None),
    limited("estimator_bytes", "RAM of the estimator", 96_000),
    figure("image_ram_bytes", "static RAM of its image", None),
    limited("stack_bytes", "deepest stack of a call", 4_000),
    limited("start_stack_bytes", "deepest stack of its creation", 16_000),
    limited("panics", "panicking functions in the image", 0),
    figure(
        "ignored_frame_mean",
        "instructions an ignored frame",
        Some(100),
    ),
    figure("ignored_frame_worst", "worst", None),
    figure("relevant_frame_mean", "a relevant frame", Some(400)),
    figure("relevant_frame_worst", "worst", None),
    figure("full_step_mean", "a filter step, both updates", None),
    figure("full_step_worst", "worst", None),
    figure("step_mean", "a filter step, whatever is there", None),
    figure("step_worst", "worst", None),
    figure("lag_mean", "smoothing a cell", None),
    figure("cell_mean", "all of a cell", None),
    figure("share_mean", "a share of the smoothing", None),
    figure("share_worst", "worst", None),
    figure("live_mean", "the live estimate", None),
    figure("live_worst", "worst", None),
    figure(
        "map_flash_bytes",
        "flash of estimator and map reader",
        Some(110_000),
    ),
    figure(
        "map_ram_bytes",
        "static RAM of the image with a map",
        Some(104_000),
    ),
    figure("on_map_bytes", "RAM of what follows the map", None),
    figure("map_stack_bytes", "deepest stack with a map", Some(4_000)),
    figure("map_panics", "panicking functions with a map", Some(0)),
    figure("map_step_mean", "the map's part of a cell", Some(1_500)),
    figure("map_step_worst", "worst", None),
    figure("map_finish_mean", "a finished cell against the map", None),
    figure("map_finish_worst", "worst", None),
    figure("ahead_mean", "a part of the road ahead", None),
    figure("ahead_worst", "worst", Some(20_000)),
    figure("persistent_state", "what a drive leaves, as bytes", None),
    figure("drain_worst", "a share of the end of a drive", None),
    figure(
        "memory_flash_bytes",
        "flash of estimator and road memory",
        None,
    ),
    figure(
        "memory_ram_bytes",
        "static RAM of the image with one of 64 kB",
        None,
    ),
    figure("memory_bytes", "RAM of a road memory of 64 kB", None),
    figure(
        "memory_panics",
        "panicking functions with a road memory",
        Some(0),
    ),
    figure(
        "memory_stack_bytes",
        "deepest stack with a road memory",
        Some(4_000),
    ),
    figure(
        "memory_step_mean",
        "the memory's part of a cell",
        Some(1_500),
    ),
    figure("memory_step_worst", "worst", Some(20_000)),
    figure("memory_finish_mean", "a finished cell learned", None),
    figure("memory_finish_worst", "worst", Some(20_000)),
    figure(
        "memory_write_worst",
        "a finished cell with a write, into RAM",
        None,
    ),
    limited("call_worst", "the worst call of all", 60_000),
    figure(FULL_BUS, "full bus, millionths of 168 MHz", Some(30_000)),
];
const FULL_BUS: &str = "full_bus_millionths";

/// Number of frames a second on a full bus: 29-bit identifiers, eight bytes, no stuff bits.
const FULL_BUS_FRAMES: u64 = 250_000 / 131;
/// Number of cells a second, at 90 km/h.
const CELLS: u64 = 10;
const INSTRUCTIONS: u64 = 168_000_000;

/// Largest accepted increase of a count over the committed one, %.
const SLACK_PERCENT: u32 = 3;

/// Figures by name.
type BudgetColumn = BTreeMap<String, u32>;

/// Figures of each target, scalar and vehicle.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Budgets {
    columns: Vec<(String, BudgetColumn)>,
}

/// Returns the upper bound of a figure for `f32` on a Cortex-M4F.
#[must_use]
pub fn wanted(figure: &str) -> Option<u32> {
    let known = FIGURES.iter().find(|known| known.name == figure);
    known.and_then(|known| known.bar)
}

/// Returns the path of the committed table.
#[must_use]
pub fn committed_file() -> PathBuf {
    root().join("firmware/budgets.csv")
}

/// Builds the images and counts, on each board.
///
/// # Errors
/// An image cannot be built or run.
pub fn measure() -> Result<Budgets> {
    measure_on(BOARDS, &drive())
}

/// Builds the images and counts, on these boards and with this drive.
///
/// # Errors
/// An image cannot be built or run.
pub fn measure_on(
    boards: impl IntoIterator<Item = BoardTarget>,
    drive: &[TimedFrame],
) -> Result<Budgets> {
    let mut budgets = Budgets::default();
    let map = drive_map();
    let vehicles = [("", truck()), (" effects", truck_with_every_effect())];
    for board in boards {
        let images = build(&root().join("firmware"), board.target, IMAGE_PROFILE)?;
        let linked: Vec<BudgetColumn> = board
            .scalars
            .iter()
            .map(|scalar| read_off(&images, scalar))
            .collect::<Result<_>>()?;
        for (suffix, vehicle) in &vehicles {
            let counted = counted(&board, &images, vehicle, drive, &map)?;
            for ((scalar, mut column), linked) in counted.into_iter().zip(&linked) {
                column.extend(linked.clone());
                let name = format!("{} {scalar}{suffix}", board.target);
                budgets.columns.push((name, column));
            }
        }
    }
    Ok(budgets)
}

/// Returns the counts of a board in its first scalar type, with another map.
///
/// # Errors
/// An image cannot be built or run.
pub fn counts_with_map(board: &BoardTarget, map: &[u8]) -> Result<BTreeMap<String, u32>> {
    let images = build(&root().join("firmware"), board.target, IMAGE_PROFILE)?;
    let columns = counted(board, &images, &truck(), &drive(), map)?;
    Ok(columns.into_iter().next().unwrap_or_default().1)
}

/// Returns the counts of the board, by scalar type.
fn counted(
    board: &BoardTarget,
    images: &Path,
    model: &Model,
    drive: &[TimedFrame],
    map: &[u8],
) -> Result<Vec<(String, BudgetColumn)>> {
    let image = images.join("budget");
    let printed = count(board.machine, &image, &drive_file(model, drive), Some(map))?;
    let printed = String::from_utf8_lossy(&printed);
    let mut columns: Vec<(String, BudgetColumn)> = Vec::new();
    for line in printed.lines() {
        let problem = || Error::content(&image, format!("printed \"{line}\": expected a figure"));
        if let Some(scalar) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            columns.push((scalar.to_owned(), BudgetColumn::new()));
            continue;
        }
        let (name, number) = line.split_once(' ').ok_or_else(problem)?;
        let number = number.parse().map_err(|_| problem())?;
        let (_, column) = columns.last_mut().ok_or_else(problem)?;
        column.insert(name.to_owned(), number);
    }
    for (scalar, column) in &mut columns {
        let of = |name: &str| {
            let figure = column.get(name).map(|figure| u64::from(*figure));
            figure.ok_or_else(|| Error::content(&image, format!("no {name} of {scalar}")))
        };
        let a_second = FULL_BUS_FRAMES * of("relevant_frame_mean")? + CELLS * of("cell_mean")?;
        let millionths = (a_second * 1_000_000).div_ceil(INSTRUCTIONS);
        column.insert(FULL_BUS.to_owned(), millionths as u32);
    }
    let found: Vec<&str> = columns.iter().map(|(scalar, _)| scalar.as_str()).collect();
    if found != board.scalars {
        let problem = format!("counted {found:?}: expected {:?}", board.scalars);
        return Err(Error::content(&image, problem));
    }
    Ok(columns)
}

/// Returns the figures that are read from the linked images.
fn read_off(images: &Path, scalar: &str) -> Result<BudgetColumn> {
    let read = |name: &str| {
        let path = images.join(name);
        let image = Image::read(&path)?;
        for panic in &image.panics {
            eprintln!("{}: may call {panic}", path.display());
        }
        Ok::<Image, Error>(image)
    };
    let nothing = Image::read(&images.join("alone_nothing"))?;
    let image = read(&format!("alone_{scalar}"))?;
    let mut figures = BudgetColumn::from([
        ("image_flash_bytes".to_owned(), image.flash_bytes),
        ("image_ram_bytes".to_owned(), image.ram_bytes),
    ]);
    for (prefix, image) in [
        ("", image),
        ("map_", read(&format!("alone_{scalar}_map"))?),
        ("memory_", read(&format!("alone_{scalar}_memory"))?),
    ] {
        let mut put = |name: &str, figure| figures.insert(format!("{prefix}{name}"), figure);
        put("flash_bytes", image.flash_bytes - nothing.flash_bytes);
        put("panics", image.panics.len() as u32);
        if !prefix.is_empty() {
            put("ram_bytes", image.ram_bytes);
        }
    }
    Ok(figures)
}

impl Budgets {
    /// Reads a table.
    ///
    /// # Errors
    /// The file cannot be read, or contains anything but figures.
    pub fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).map_err(Error::io(path))?;
        let mut lines = text.lines();
        let names = lines.next().unwrap_or_default().split(',').skip(1);
        let columns = names.map(|name| (name.to_owned(), BudgetColumn::new()));
        let mut budgets = Self {
            columns: columns.collect(),
        };
        for (number, line) in (2..).zip(lines) {
            let mut fields = line.split(',');
            let figure = fields.next().unwrap_or_default();
            let figures: Vec<u32> = fields
                .map(str::parse)
                .collect::<std::result::Result<_, _>>()
                .unwrap_or_default();
            if !FIGURES.iter().any(|known| known.name == figure)
                || figures.len() != budgets.columns.len()
            {
                let problem = format!("line {number}: expected a figure of each column");
                return Err(Error::content(path, problem));
            }
            for ((_, column), value) in budgets.columns.iter_mut().zip(figures) {
                column.insert(figure.to_owned(), value);
            }
        }
        Ok(budgets)
    }

    /// Returns the table as [`Budgets::read`] reads it.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let lines = FIGURES.iter().map(|figure| self.row(figure, figure.name));
        let header = self.header("figure");
        let lines = std::iter::once(header).chain(lines);
        lines.map(|line| line.join(",") + "\n").collect()
    }

    /// Returns the table as text, with the upper bounds.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut header = self.header("");
        header.push("bar".to_owned());
        let rows: Vec<Vec<String>> = FIGURES
            .iter()
            .map(|figure| {
                let mut row = self.row(figure, figure.words);
                row.push(figure.bar.map(|bar| bar.to_string()).unwrap_or_default());
                row
            })
            .collect();
        text_table(&header, &rows, 1).to_string()
    }

    /// Returns a figure of a column. A column is named by target, scalar type, and `effects` if the
    /// vehicle has them.
    #[must_use]
    pub fn figure(&self, column: &str, figure: &str) -> Option<u32> {
        self.column(column)?.get(figure).copied()
    }

    fn header(&self, first: &str) -> Vec<String> {
        let names = self.columns.iter().map(|(name, _)| name.clone());
        std::iter::once(first.to_owned()).chain(names).collect()
    }

    fn column(&self, name: &str) -> Option<&BudgetColumn> {
        let mut columns = self.columns.iter();
        columns.find(|known| known.0 == name).map(|known| &known.1)
    }

    fn row(&self, figure: &BudgetRow, first: &str) -> Vec<String> {
        let figures = self.columns.iter().map(|(_, column)| {
            let value = column.get(figure.name);
            value.map(u32::to_string).unwrap_or_default()
        });
        std::iter::once(first.to_owned()).chain(figures).collect()
    }

    /// Returns one line for each figure above its limit.
    #[must_use]
    pub fn beyond_limits(&self) -> Vec<String> {
        let board = format!("{} f32", CORTEX_M4F.target);
        let columns = self.columns.iter();
        columns
            .filter(|(name, _)| name.starts_with(&board))
            .flat_map(|(name, column)| {
                FIGURES.iter().filter_map(move |figure| {
                    let most = figure.bar.filter(|_| figure.is_limit)?;
                    let value = column.get(figure.name).filter(|value| **value > most)?;
                    let of = figure.name;
                    Some(format!("{name}: {of}: {value}, more than the limit {most}"))
                })
            })
            .collect()
    }

    /// Returns one line for each figure that exceeds `committed` by more than the slack, or that is
    /// not in both tables.
    #[must_use]
    pub fn excesses(&self, committed: &Self) -> Vec<String> {
        let mut excesses = Vec::new();
        for (name, _) in &committed.columns {
            if self.column(name).is_none() {
                excesses.push(format!("{name}: committed, but not counted"));
            }
        }
        for (name, column) in &self.columns {
            let Some(allowed) = committed.column(name) else {
                excesses.push(format!("{name}: counted, but not committed"));
                continue;
            };
            for (figure, &value) in column {
                match allowed.get(figure) {
                    None => excesses.push(format!("{name}: {figure}: not committed")),
                    Some(&least) if exceeds(value, least) => excesses.push(format!(
                        "{name}: {figure}: {value}, more than {SLACK_PERCENT} % above {least}"
                    )),
                    Some(_) => {}
                }
            }
        }
        excesses
    }
}

fn exceeds(value: u32, committed: u32) -> bool {
    u64::from(value) * 100 > u64::from(committed) * u64::from(100 + SLACK_PERCENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budgets(step: u32) -> Budgets {
        let column = [("full_step_mean".to_owned(), step)].into();
        let columns = vec![("board f32".to_owned(), column)];
        Budgets { columns }
    }

    #[test]
    fn a_count_may_grow_by_the_slack_and_no_more() {
        let committed = budgets(1_000);
        assert!(budgets(900).excesses(&committed).is_empty());
        assert!(budgets(1_030).excesses(&committed).is_empty());
        let excesses = budgets(1_031).excesses(&committed);
        let expected = "board f32: full_step_mean: 1031, more than 3 % above 1000";
        assert_eq!(excesses, [expected]);
        // The slack does not apply to a bound of zero.
        assert_eq!(budgets(1).excesses(&budgets(0)).len(), 1);
    }

    #[test]
    fn limits_hold_for_floats_on_the_larger_board() {
        let budgets = |board: &str, call| {
            let column = [("call_worst".to_owned(), call)].into();
            let columns = vec![(board.to_owned(), column)];
            Budgets { columns }
        };
        let floats = "thumbv7em-none-eabihf f32 effects";
        assert!(budgets(floats, 60_000).beyond_limits().is_empty());
        let beyond = budgets(floats, 60_001).beyond_limits();
        let expected = format!("{floats}: call_worst: 60001, more than the limit 60000");
        assert_eq!(beyond, [expected]);
        let others = ["thumbv7em-none-eabihf fixed", "thumbv6m-none-eabi f32"];
        for other in others {
            assert!(budgets(other, 60_001).beyond_limits().is_empty());
        }
        let committed = Budgets::read(&committed_file()).unwrap();
        assert_eq!(committed.beyond_limits(), Vec::<String>::new());
    }

    #[test]
    fn what_is_not_in_both_tables_is_reported() {
        let (none, one) = (Budgets::default(), budgets(1));
        assert_eq!(one.excesses(&none).len(), 1);
        assert_eq!(none.excesses(&one).len(), 1);
    }

    #[test]
    fn the_committed_table_is_read_as_it_is_written() {
        let path = committed_file();
        let committed = Budgets::read(&path).unwrap();
        assert_eq!(committed.to_csv(), fs::read_to_string(&path).unwrap());
        for (_, column) in committed.columns {
            assert_eq!(column.len(), FIGURES.len());
        }
    }
}
