//! The page of a map: plan, profiles, and their standard deviations.

use crate::map::{GRID_M, MapRow, WayRows, map_segments};
use crate::report::page::{Figure, Page, Section, Table};
use crate::report::plan::{Classes, PlanLine, plan};
use crate::report::plot::{Plot, Series, colour};
use plotters::style::RGBColor;
use std::path::Path;

/// Largest number of profiles; the longest ways have one.
const MOST_PROFILES: usize = 12;
/// Largest number of rows in the table of ways; the longest ways are listed.
const MOST_LISTED: usize = 200;
/// From downhill over level to uphill; distinguishable for the colour-blind.
const GRADE_COLOURS: [RGBColor; 7] = [
    RGBColor(0x08, 0x45, 0x94),
    RGBColor(0x42, 0x92, 0xc6),
    RGBColor(0x9e, 0xca, 0xe1),
    RGBColor(0xb0, 0xb0, 0xb0),
    RGBColor(0xfd, 0xae, 0x6b),
    RGBColor(0xe6, 0x55, 0x0d),
    RGBColor(0x8c, 0x2d, 0x04),
];
/// From a small standard deviation to a large one.
const SIGMA_COLOURS: [RGBColor; 4] = [
    RGBColor(0x00, 0x44, 0x7c),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0xb3, 0x3c, 0x00),
];

pub(crate) fn page(file: &Path, ways: &[WayRows]) -> Page {
    let mut longest: Vec<&WayRows> = ways.iter().collect();
    // Stable sort: ways of equal length stay in the order of their names.
    longest.sort_by_key(|way| std::cmp::Reverse(way.rows.len()));
    let drawn = &longest[..longest.len().min(MOST_PROFILES)];
    let mut sections = vec![plan_section(ways)];
    let numbered = drawn.iter().enumerate();
    sections.extend(numbered.map(|(number, way)| profile_section(number, way)));
    if ways.len() > 1 {
        sections.push(table_section(&longest));
    }
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    Page {
        title: format!("Grade map: {name}"),
        lead: lead(ways, drawn.len()),
        sections,
    }
}

fn lead(ways: &[WayRows], drawn: usize) -> String {
    let rows: Vec<&MapRow> = ways.iter().flat_map(|way| &way.rows).collect();
    let runs = || rows.iter().map(|row| row.runs);
    let sigmas = rows.iter().map(|row| row.grade_sigma_percent);
    let mut words = format!(
        "{:.1} km of road in cells of {GRID_M} m, from {} to {} runs each. Half of the cells have \
         a standard deviation below {:.3} % grade.",
        km(rows.len()),
        runs().min().unwrap_or(0),
        runs().max().unwrap_or(0),
        quantile(sigmas, 0.5),
    );
    if ways.len() > 1 {
        words += &format!(" {} ways", ways.len());
        if drawn < ways.len() {
            words += &format!(", of which the {drawn} longest have a profile");
        }
        words += ".";
    }
    words
}

fn km(cells: usize) -> f64 {
    cells as f64 * GRID_M * 1e-3
}

fn quantile(values: impl Iterator<Item = f64>, part: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let at = (part * last as f64).round() as usize;
    values.get(at).copied().unwrap_or(0.0)
}

fn plan_section(ways: &[WayRows]) -> Section {
    let rows = || ways.iter().flat_map(|way| &way.rows);
    let steep = quantile(rows().map(|row| row.grade_percent.abs()), 0.9);
    // The outermost limits are 2.5 steps from level.
    let step = nice_above(steep / 2.5);
    let grades = Classes {
        limits: [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5]
            .map(|n| tidy(n * step))
            .to_vec(),
        colours: GRADE_COLOURS.to_vec(),
        unit: "%",
    };
    let sigmas = || rows().map(|row| row.grade_sigma_percent);
    let mut limits: Vec<f64> = [0.25, 0.5, 0.9]
        .map(|part| nice_above(quantile(sigmas(), part)))
        .to_vec();
    limits.dedup();
    let sigma_classes = Classes {
        colours: SIGMA_COLOURS[..=limits.len()].to_vec(),
        limits,
        unit: "%",
    };
    let lines = |value: fn(&MapRow) -> f64| -> Vec<PlanLine> {
        let segments = ways.iter().flat_map(|way| map_segments(&way.rows));
        segments
            .map(|rows| PlanLine {
                points: rows
                    .iter()
                    .map(|row| (row.latitude_deg, row.longitude_deg, value(row)))
                    .collect(),
            })
            .collect()
    };
    let directions = if ways.len() > 1 {
        " Each way is drawn slightly to the right of its position."
    } else {
        ""
    };
    let grade = plan(&lines(|row| row.grade_percent), &grades);
    let sigma = plan(&lines(|row| row.grade_sigma_percent), &sigma_classes);
    Section {
        heading: "Plan".to_owned(),
        words: Vec::new(),
        tables: Vec::new(),
        figures: vec![
            Figure::new(
                "plan_grade",
                &grade,
                format!("Grade in the direction of travel; uphill is positive.{directions}"),
            ),
            Figure::new("plan_sigma", &sigma, "Standard deviation of the grade."),
        ],
    }
}

/// Returns the smallest of 1, 1.5, 2, 3, 5, 7 times a power of ten that is at least `value`.
fn nice_above(value: f64) -> f64 {
    let value = value.max(1e-3);
    let power = 10_f64.powi(value.log10().floor() as i32);
    let nice = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|n| n * power);
    let found = nice.into_iter().find(|nice| *nice >= value * (1.0 - 1e-9));
    tidy(found.unwrap_or(10.0 * power))
}

/// Rounds off the error of binary fractions.
fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn table_section(longest: &[&WayRows]) -> Section {
    let header = [
        "way",
        "direction",
        "km",
        "climb m",
        "least grade %",
        "most grade %",
        "runs",
        "sigma % (median)",
    ];
    let listed = &longest[..longest.len().min(MOST_LISTED)];
    let caption = if listed.len() < longest.len() {
        format!("The {} longest of {} ways.", listed.len(), longest.len())
    } else {
        "Longest first. Climb is the altitude gain less the loss.".to_owned()
    };
    Section {
        heading: "Ways".to_owned(),
        tables: vec![
            Table::new("ways", caption, &header).with_rows(listed.iter().map(|way| row(way))),
        ],
        ..Section::default()
    }
}

fn row(way: &WayRows) -> Vec<String> {
    let grades = || way.rows.iter().map(|row| row.grade_percent);
    let climb_m: f64 = grades().map(|grade| GRID_M * grade / 100.0).sum();
    let runs = quantile(way.rows.iter().map(|row| f64::from(row.runs)), 0.5);
    let sigma = quantile(way.rows.iter().map(|row| row.grade_sigma_percent), 0.5);
    let (name, direction) = way
        .name
        .as_ref()
        .map_or(("", ""), |name| (name.way.as_str(), name.direction.word()));
    vec![
        name.to_owned(),
        direction.to_owned(),
        format!("{:.2}", km(way.rows.len())),
        format!("{climb_m:+.1}"),
        format!("{:+.2}", quantile(grades(), 0.0)),
        format!("{:+.2}", quantile(grades(), 1.0)),
        format!("{runs:.0}"),
        format!("{sigma:.3}"),
    ]
}

fn profile_section(number: usize, way: &WayRows) -> Section {
    let figure = |name: &str, plot: &Plot, caption: &str| {
        Figure::new(format!("{name}_{number}"), plot, caption)
    };
    let mut grade = Plot::new("distance (km)", "grade (%)");
    let mut sigma = Plot::new("distance (km)", "sigma of grade (%)");
    let mut runs = Plot::new("distance (km)", "runs");
    (sigma.height, runs.height) = (220, 180);
    let most = |value: fn(&MapRow) -> f64| way.rows.iter().map(value).fold(0.0, f64::max);
    sigma.y_range = Some((0.0, 1.1 * most(|row| row.grade_sigma_percent)));
    runs.y_range = Some((0.0, 1.1 * most(|row| f64::from(row.runs))));
    for (part, rows) in map_segments(&way.rows).enumerate() {
        // The legend lists each colour once.
        let name = |name: &str| {
            if part == 0 {
                name.to_owned()
            } else {
                String::new()
            }
        };
        let along = |value: fn(&MapRow) -> f64| {
            rows.iter()
                .map(move |row| (row.distance_m * 1e-3, value(row)))
        };
        let band = rows.iter().map(|row| {
            (
                row.distance_m * 1e-3,
                row.grade_percent,
                row.grade_sigma_percent,
            )
        });
        grade = grade
            .with(Series::two_sigma(name("± 2 sigma"), colour::BLUE, band))
            .with(Series::line(
                name("grade"),
                colour::BLUE,
                along(|row| row.grade_percent),
            ));
        sigma = sigma.with(Series::line(
            "",
            colour::ORANGE,
            along(|row| row.grade_sigma_percent),
        ));
        runs = runs.with(Series::line(
            "",
            colour::BLACK,
            along(|row| f64::from(row.runs)),
        ));
    }
    Section {
        heading: way
            .name
            .as_ref()
            .map_or_else(|| "Along the road".to_owned(), |name| format!("Way {name}")),
        words: Vec::new(),
        tables: Vec::new(),
        figures: vec![
            figure(
                "grade",
                &grade,
                "Grade in the direction of travel. A gap has no run.",
            ),
            figure("sigma", &sigma, "Standard deviation of the grade."),
            figure("runs", &runs, "Number of runs."),
        ],
    }
}
