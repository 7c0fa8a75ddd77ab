//! The page of `map`: what logs of one vehicle show of their roads.

use super::digits::{place_of, rounded, to_place};
use super::map_page;
use super::page::{Figure, Note, Page, Section, Table};
use super::plot::shaded_ranges;
use super::plot::{Plot, Series, colour};
use super::verdict::{suspect_section, with_verdict, with_warnings};
use crate::error::on_one_line;
use crate::files::run::RunRow;
use crate::identify::annotated::comment;
use crate::identify::{Identified, IdentifiedValue, Origin};
use crate::map::{GRID_M, Network, PlacedCell, PlacedRun, WayRows};
use crate::recorder::{RunSummary, Warning};
use crate::source::log_report::LogReport;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Most ways that have a figure of each run, and most runs in one.
const MOST_WAYS: usize = 8;
const MOST_RUNS: usize = 12;

/// What a person knows of a vehicle: words, and key.
const KNOWN: [(&str, &str); 6] = [
    ("mass, kg", "vehicle.mass_kg"),
    ("drag area, m²", "vehicle.drag_area_m2"),
    ("rolling resistance", "vehicle.rolling_resistance"),
    ("wheel radius, m", "vehicle.wheel_radius_m"),
    ("torque at 100 %, N m", "powertrain.reference_torque_nm"),
    ("final drive", "powertrain.final_drive_ratio"),
];

/// One run of the map.
pub struct LogRun {
    /// Its name.
    pub name: String,
    /// Its cells.
    pub rows: Vec<RunRow>,
    /// Its summary.
    pub summary: RunSummary,
    /// What the reading of each of its logs told.
    pub reports: Vec<(PathBuf, LogReport)>,
    /// What is not plausible about its input.
    pub warnings: Vec<Warning>,
}

/// The map and where it comes from.
pub struct LogsMap<'a> {
    /// The roads.
    pub network: &'a Network,
    /// The runs as they lie on the roads, in their order.
    pub placed: &'a [PlacedRun],
    /// The ways of the map.
    pub ways: &'a [WayRows],
    /// The runs.
    pub runs: &'a [LogRun],
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// How the vehicle was identified; `None` if its file was given.
    pub identified: Option<&'a Identified>,
    /// Why logs were left out, a line each.
    pub left_out: &'a [String],
    /// What is not plausible about the drives beside each other.
    pub warnings: &'a [Warning],
}

impl LogRun {
    /// Header of the table of runs.
    pub const HEADER: [&'static str; 6] = ["run", "km", "sigma %", "valid %", "mass kg", "verdict"];

    /// Returns the run's line of the table.
    #[must_use]
    pub fn line(&self) -> Vec<String> {
        let of = &self.summary;
        let mass = |(kg, sigma_kg): (f64, f64)| format!("{kg:.0} ± {sigma_kg:.0}");
        let mass = of.mass_kg.zip(of.mass_sigma_kg).map(mass);
        vec![
            self.name.clone(),
            format!("{:.2}", of.distance_km),
            format!("{:.3}", of.grade_sigma_percent),
            format!("{:.1}", of.valid_percent),
            mass.unwrap_or_default(),
            of.verdict.clone(),
        ]
    }
}

/// Creates the page.
#[must_use]
pub fn logs_page(map: &LogsMap) -> Page {
    let mut page = map_page::page(Path::new("map"), map.ways, |way| {
        suspect_stretches(map, way)
    });
    page.title = format!("Grade map from logs of a vehicle like {}", map.vehicle);
    with_verdict(page, &summaries(map), wrong_section(map))
        .with(runs_section(map))
        .with(vehicle_section(map))
}

fn summaries<'a>(map: &'a LogsMap) -> Vec<(&'a str, &'a RunSummary)> {
    let runs = map.runs.iter();
    runs.map(|run| (run.name.as_str(), &run.summary)).collect()
}

/// Returns the stretches of a way in which signals of a run disagree, km.
fn suspect_stretches(map: &LogsMap, way: &WayRows) -> Vec<(f64, f64)> {
    let placed = map
        .placed
        .iter()
        .flat_map(|placed| placed_on(map, placed, way));
    let suspect = placed.filter(|cell| !cell.is_consistent);
    let suspect: BTreeSet<i64> = suspect.map(|cell| cell.number).collect();
    shaded_ranges(way.rows.iter().map(|row| {
        let number = (row.distance_m / GRID_M).round() as i64;
        (row.distance_m * 1e-3, suspect.contains(&number))
    }))
}

/// Returns the cells of a run on a way.
fn placed_on<'a>(
    map: &LogsMap<'a>,
    placed: &'a PlacedRun,
    way: &WayRows,
) -> impl Iterator<Item = &'a PlacedCell> {
    let index = map.network.ways().iter().position(|of| of.name == way.name);
    placed
        .cells
        .iter()
        .filter(move |cell| Some(cell.way) == index)
}

fn runs_section(map: &LogsMap) -> Section {
    let words = "One line for each drive: its length, the mean standard deviation of its smoothed \
                 grade, and whether its signals agree. Suspect cells count less in the map.";
    let table = Table::new("runs", "Runs of the map.", &LogRun::HEADER)
        .with_rows(map.runs.iter().map(LogRun::line));
    let section = Section::new("Runs").paragraph(words).table(table);
    if map.runs.len() == 1 {
        return section; // Its grade is that of the map.
    }
    let drawn = map.ways.iter().take(MOST_WAYS).enumerate();
    drawn.fold(section, |section, (number, way)| {
        section.figure(runs_figure(map, number, way))
    })
}

/// Returns the figure of the grades of each run along a way.
fn runs_figure(map: &LogsMap, number: usize, way: &WayRows) -> Figure {
    let name = way
        .name
        .as_ref()
        .map_or_else(|| "the road".to_owned(), |name| format!("way {name}"));
    let mut plot = Plot::profile("grade (%)", map_page::link(way));
    let mut left_out = 0;
    for (run, placed) in map.runs.iter().zip(map.placed) {
        let points: Vec<(f64, f64)> = placed_on(map, placed, way)
            .map(|cell| (cell.number as f64 * GRID_M * 1e-3, cell.grade_percent))
            .collect();
        if points.is_empty() {
            continue;
        }
        if plot.series.len() == MOST_RUNS {
            left_out += 1;
            continue;
        }
        let colour = colour::CYCLE[plot.series.len() % colour::CYCLE.len()];
        plot = plot.with(Series::line(run.name.as_str(), colour, points));
    }
    let more = match left_out {
        0 => String::new(),
        count => format!(" {count} more runs are not drawn."),
    };
    let caption = format!("Smoothed grade of each run along {name}.{more}");
    Figure::new(format!("each_run_{number}"), &plot, caption)
}

fn vehicle_section(map: &LogsMap) -> Section {
    let section = Section::new("Vehicle");
    let Some(found) = map.identified else {
        return section.paragraph("The vehicle file was given with --vehicle.");
    };
    let section = section.paragraph(format!(
        "The vehicle is identified from the logs. Where they do not tell, it has what is usual for \
         {}. The grade depends on the ratio of traction to mass, which the drives show.",
        found.class
    ));
    let unknown = found.unknown.iter().fold(section, |section, unknown| {
        let message = format!("Not known: {}.", unknown.what);
        section.note(Note::info(format!("{message} {}", unknown.advice)))
    });
    let row = |value: &IdentifiedValue| vec![value.key.clone(), amount(value), comment(value)];
    let header = ["key", "value", "from"];
    let whole = Table::new("vehicle", "Every value of the vehicle file.", &header)
        .with_rows(found.values.iter().map(row))
        .with_words();
    unknown.table(known_table(found)).table(whole.folded())
}

/// Returns the table of what a person knows of a vehicle.
fn known_table(found: &Identified) -> Table {
    let row = |(words, key): (&str, &str)| {
        let value = found.values.iter().find(|value| value.key == key)?;
        Some(vec![words.to_owned(), amount(value), comment(value)])
    };
    let rows = KNOWN.into_iter().filter_map(row).chain(gears(found));
    Table::new("vehicle_in_short", "The vehicle.", &["", "value", "from"])
        .with_rows(rows)
        .with_words()
}

/// Returns the line of all gears.
fn gears(found: &Identified) -> Option<Vec<String>> {
    let is_ratio = |value: &&IdentifiedValue| {
        value.key.starts_with("powertrain.gears[") && value.key.ends_with(".ratio")
    };
    let gears: Vec<&IdentifiedValue> = found.values.iter().filter(is_ratio).collect();
    let (first, last) = (gears.first()?, gears.last()?);
    let count = |origin: Origin| gears.iter().filter(|gear| gear.origin == origin).count();
    let ratios = format!("{:.2} to {:.2}", first.value, last.value);
    let from = format!(
        "{} read, {} measured, {} assumed",
        count(Origin::Read),
        count(Origin::Measured),
        count(Origin::Assumed)
    );
    Some(vec![format!("{} gears", gears.len()), ratios, from])
}

/// Returns a value with as many digits as its sigma allows.
fn amount(value: &IdentifiedValue) -> String {
    if value.origin == Origin::Read || value.sigma <= 0.0 {
        return rounded(value.value, 5).to_string();
    }
    let place = place_of(value.sigma) - 1;
    let decimals = usize::try_from(-place).unwrap_or(0);
    format!("{:.decimals$}", to_place(value.value, place))
}

/// Returns what is wrong with the input.
fn wrong_section(map: &LogsMap) -> Section {
    let mut section = suspect_section(&summaries(map));
    for problem in map.left_out {
        section = section.note(Note::warning(
            format!("Left out: {problem}."),
            "The map is made of the other logs.",
        ));
    }
    section = with_warnings(section, "", map.warnings);
    for run in map.runs {
        for (log, report) in &run.reports {
            if let Some(damage) = report.damage.words() {
                let message = format!("{}: {damage}.", on_one_line(log));
                section = section.note(Note::warning(message, report.damage.first.join("; ")));
            }
        }
        section = with_warnings(section, &format!("{}: ", run.name), &run.warnings);
    }
    section
}
