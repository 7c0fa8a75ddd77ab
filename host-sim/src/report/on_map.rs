//! What a map gave on a drive: its grade and the live grade with it, beside the smoothed one.

use super::page::{Figure, Section, Table};
use super::plot::{Plot, colour};
use super::profile::ProfilePoint;
use crate::files::run::RunRow;
use crate::map::GRID_M;

/// A cell of a drive with a place on the map. Grades in %.
#[derive(Clone, Copy, Debug)]
pub struct OnMapCell {
    distance_m: f64,
    smoothed: (f64, f64),
    live: (f64, f64),
    map: (f64, f64),
}

impl OnMapCell {
    /// Returns what a row of a run has of the map; `None` if it has nothing.
    #[must_use]
    pub fn of(row: &RunRow) -> Option<Self> {
        Some(Self {
            distance_m: row.distance_m,
            smoothed: (row.grade_percent, row.grade_sigma_percent),
            live: (row.live_grade_percent, row.live_grade_sigma_percent),
            map: row.map_grade_percent.zip(row.map_grade_sigma_percent)?,
        })
    }
}

/// Returns the section of a drive of `cells` cells, of which some were on the map.
#[must_use]
pub fn on_map_section(on_map: &[OnMapCell], cells: usize) -> Section {
    let part = 100.0 * on_map.len() as f64 / cells.max(1) as f64;
    let words = format!(
        "The map counted in {:.1} km, {part:.0} % of the drive. The live grade there is combined with \
         the map's. The smoothed grade never contains the map.",
        on_map.len() as f64 * GRID_M * 1e-3
    );
    type Value = fn(&OnMapCell) -> (f64, Option<f64>);
    let points = |value: Value| {
        on_map.iter().map(move |cell| {
            let (value, sigma) = value(cell);
            ProfilePoint {
                distance_m: cell.distance_m,
                value,
                sigma,
            }
        })
    };
    let grades = Plot::profile("grade (%)", "road")
        .with_profile("map", colour::ORANGE, points(|c| (c.map.0, Some(c.map.1))))
        .with_profile("smoothed", colour::BLUE, points(|c| (c.smoothed.0, None)))
        .with_profile(
            "live, with the map",
            colour::GREEN,
            points(|c| (c.live.0, None)),
        );
    let mut differences = Plot::profile("difference (%)", "road")
        .with_profile(
            "map",
            colour::ORANGE,
            points(|c| (c.map.0 - c.smoothed.0, None)),
        )
        .with_profile(
            "live, with the map",
            colour::GREEN,
            points(|c| (c.live.0 - c.smoothed.0, None)),
        );
    differences.height = 240;
    Section::new("With the map")
        .paragraph(words)
        .table(table(on_map))
        .figure(Figure::new(
            "with_map",
            &grades,
            "Grade of the map, and of the estimate on it. A gap has no place on the map, or the map \
             was left out.",
        ))
        .figure(Figure::new(
            "with_map_differences",
            &differences,
            "Differences from the smoothed grade of this drive.",
        ))
}

fn table(on_map: &[OnMapCell]) -> Table {
    let line = |name: &str, value: fn(&OnMapCell) -> (f64, f64)| {
        let count = on_map.len().max(1) as f64;
        let mean = |of: &dyn Fn(&OnMapCell) -> f64| on_map.iter().map(of).sum::<f64>() / count;
        let difference = |cell: &OnMapCell| value(cell).0 - cell.smoothed.0;
        vec![
            name.to_owned(),
            format!("{:+.3}", mean(&difference)),
            format!("{:.3}", mean(&|cell| difference(cell).powi(2)).sqrt()),
            format!("{:.3}", mean(&|cell| value(cell).1)),
        ]
    };
    let header = ["grade", "mean difference %", "RMS difference %", "sigma %"];
    let caption = "Against the smoothed grade of this drive; sigma is the mean standard deviation.";
    Table::new("with_map", caption, &header).with_rows([
        line("map", |cell| cell.map),
        line("live, with the map", |cell| cell.live),
        line("smoothed", |cell| cell.smoothed),
    ])
}
