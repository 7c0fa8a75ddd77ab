//! The page of `map`: what logs of one vehicle show of their roads.

use super::map_page;
use super::page::{Page, Section, Table};
use crate::files::run::RunRow;
use crate::identify::annotated::comment;
use crate::identify::{Identified, IdentifiedValue};
use crate::map::WayRows;
use crate::recorder::RunSummary;
use std::path::Path;

/// One run of the map.
pub struct LogRun {
    /// Its name.
    pub name: String,
    /// Its cells.
    pub rows: Vec<RunRow>,
    /// Its summary.
    pub summary: RunSummary,
}

/// The map and where it comes from.
pub struct LogsMap<'a> {
    /// The ways of the map.
    pub ways: &'a [WayRows],
    /// The runs.
    pub runs: &'a [LogRun],
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// How the vehicle was identified; `None` if its file was given.
    pub identified: Option<&'a Identified>,
    /// What was wrong with the input, a line each.
    pub problems: &'a [String],
}

impl LogRun {
    /// Header of the table of runs.
    pub const HEADER: [&'static str; 6] = ["run", "km", "sigma %", "valid %", "mass kg", "verdict"];

    /// Returns the run's line of the table.
    #[must_use]
    pub fn line(&self) -> Vec<String> {
        let of = &self.summary;
        let mass = |kg: f64, sigma_kg: f64| format!("{kg:.0} ± {sigma_kg:.0}");
        let mass = of
            .mass_kg
            .zip(of.mass_sigma_kg)
            .map(|(kg, sigma_kg)| mass(kg, sigma_kg));
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
    let mut page = map_page::page(Path::new("map"), map.ways);
    page.title = format!("Grade map from the logs of {}", map.vehicle);
    page.sections.push(Section {
        heading: "Runs".to_owned(),
        words: vec![
            "One line for each drive. The standard deviation is that of the smoothed grade, on \
             average. Cells that are suspect count less in the map."
                .to_owned(),
        ],
        tables: vec![
            Table::new("runs", "Runs of the map.", &LogRun::HEADER)
                .with_rows(map.runs.iter().map(LogRun::line)),
        ],
        ..Section::default()
    });
    page.sections.push(vehicle_section(map));
    page.sections.push(input_section(map));
    page
}

fn vehicle_section(map: &LogsMap) -> Section {
    let Some(found) = map.identified else {
        return Section {
            heading: "Vehicle".to_owned(),
            words: vec!["The vehicle file was given with --vehicle.".to_owned()],
            ..Section::default()
        };
    };
    let mut words = vec![format!(
        "The vehicle is identified from the logs. Where they do not tell, it has what is usual for \
         {}. The grade depends on the ratio of traction to mass, which the drives show.",
        found.class
    )];
    words.extend(
        found
            .unknown
            .iter()
            .map(|unknown| format!("Not known: {}. {}", unknown.what, unknown.advice)),
    );
    let row = |value: &IdentifiedValue| {
        vec![
            value.key.clone(),
            format!("{:.5}", value.value),
            comment(value),
        ]
    };
    Section {
        heading: "Vehicle".to_owned(),
        words,
        tables: vec![
            Table::new(
                "vehicle",
                "What was read, measured and assumed.",
                &["key", "value", "from"],
            )
            .with_rows(found.values.iter().map(row)),
        ],
        ..Section::default()
    }
}

fn input_section(map: &LogsMap) -> Section {
    let words = if map.problems.is_empty() {
        vec!["Nothing was wrong with the input.".to_owned()]
    } else {
        map.problems.to_vec()
    };
    Section {
        heading: "Input".to_owned(),
        words,
        ..Section::default()
    }
}
