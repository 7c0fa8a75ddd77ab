//! The page of a map: plan, profiles, and their standard deviations.

use crate::map::{GRID_M, MapRow, WayRows, map_segments};
use crate::numeric::statistics::quantile;
use crate::report::page::{Figure, Page, Section, Table};
use crate::report::plan::{Colouring, Plan, PlanLine, PlanPoint};
use crate::report::plot::{Plot, colour};
use crate::report::profile::ProfilePoint;
use std::path::Path;

/// Largest number of profiles; the longest ways have one.
const MOST_PROFILES: usize = 12;
/// Largest number of rows in the table of ways; the longest ways are listed.
const MOST_LISTED: usize = 200;

/// Returns the figures that share hover and zoom with a way: those of the same name.
pub(super) fn link(way: &WayRows) -> String {
    way.name
        .as_ref()
        .map_or_else(|| "road".to_owned(), |name| format!("way {name}"))
}

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

fn plan_section(ways: &[WayRows]) -> Section {
    let directions = if ways.len() > 1 {
        " Each way is drawn slightly to the right of its position."
    } else {
        ""
    };
    let caption = format!(
        "The map from above, north up. Grade in the direction of travel; uphill is \
         positive.{directions} A point under the pointer shows in the profile below, and the \
         other way round."
    );
    Section::new("Plan").figure(Figure::plan("plan", plan(ways), caption))
}

/// Returns the plan of a map, coloured by grade, sigma or number of runs.
#[must_use]
pub fn plan(ways: &[WayRows]) -> Plan {
    let rows = || ways.iter().flat_map(|way| &way.rows);
    let line = |way: &WayRows, rows: &[MapRow]| PlanLine {
        name: way.name.as_ref().map(|_| link(way)).unwrap_or_default(),
        link: link(way),
        points: rows.iter().map(plan_point).collect(),
    };
    Plan {
        colourings: vec![
            Colouring::grades(rows().map(|row| row.grade_percent)),
            Colouring::amounts("sigma", "%", rows().map(|row| row.grade_sigma_percent)),
            Colouring::amounts("runs", "", rows().map(|row| f64::from(row.runs))),
        ],
        lines: ways
            .iter()
            .flat_map(|way| map_segments(&way.rows).map(move |rows| line(way, rows)))
            .collect(),
    }
}

fn plan_point(row: &MapRow) -> PlanPoint {
    PlanPoint {
        latitude_deg: row.latitude_deg,
        longitude_deg: row.longitude_deg,
        distance_m: row.distance_m,
        values: vec![
            row.grade_percent,
            row.grade_sigma_percent,
            f64::from(row.runs),
        ],
    }
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
    let rows = listed.iter().map(|way| row(way));
    Section::new("Ways").table(Table::new("ways", caption, &header).with_rows(rows))
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
    let points = |value: fn(&MapRow) -> (f64, Option<f64>)| {
        way.rows.iter().map(move |row| {
            let (value, sigma) = value(row);
            ProfilePoint {
                distance_m: row.distance_m,
                value,
                sigma,
            }
        })
    };
    let profile = |y_label, name, colour, value| {
        Plot::profile(y_label, link(way)).with_profile(name, colour, points(value))
    };
    let grade = profile("grade (%)", "grade", colour::BLUE, |row| {
        (row.grade_percent, Some(row.grade_sigma_percent))
    });
    let mut sigma = profile("sigma of grade (%)", "sigma", colour::ORANGE, |row| {
        (row.grade_sigma_percent, None)
    });
    let mut runs = profile("runs", "runs", colour::BLACK, |row| {
        (f64::from(row.runs), None)
    });
    let most = |value: fn(&MapRow) -> f64| way.rows.iter().map(value).fold(0.0, f64::max);
    sigma.y_range = Some((0.0, 1.1 * most(|row| row.grade_sigma_percent)));
    runs.y_range = Some((0.0, 1.1 * most(|row| f64::from(row.runs))));
    (sigma.height, runs.height) = (220, 180);
    let figure = |name: &str, plot: &Plot, caption: &str| {
        Figure::new(format!("{name}_{number}"), plot, caption)
    };
    let heading = way
        .name
        .as_ref()
        .map_or_else(|| "Along the road".to_owned(), |name| format!("Way {name}"));
    Section::new(heading)
        .figure(figure(
            "grade",
            &grade,
            "Grade in the direction of travel. A gap has no run.",
        ))
        .figure(figure("sigma", &sigma, "Standard deviation of the grade."))
        .figure(figure("runs", &runs, "Number of runs."))
}
