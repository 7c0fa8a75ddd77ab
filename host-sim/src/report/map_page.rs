//! The page of a map: profiles of altitude and grade, and the plan.

use crate::map::{GRID_M, MapRow, WayRows, map_segments};
use crate::numeric::statistics::quantile;
use crate::report::page::{Figure, Page, Section, Table};
use crate::report::plan::{Colouring, Plan, PlanLine, PlanPoint};
use crate::report::plot::{Plot, colour};
use crate::report::profile::ProfilePoint;
use std::borrow::Cow;
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

/// Creates the page of a map. `suspect` returns the stretches of a way to shade, km. A cell without a
/// position is not on the plan.
pub(crate) fn page(
    file: &Path,
    ways: &[WayRows],
    suspect: impl Fn(&WayRows) -> Vec<(f64, f64)>,
) -> Page {
    let mut longest: Vec<&WayRows> = ways.iter().collect();
    // Stable sort: ways of equal length stay in the order of their names.
    longest.sort_by_key(|way| std::cmp::Reverse(way.rows.len()));
    let drawn = &longest[..longest.len().min(MOST_PROFILES)];
    let numbered = drawn.iter().enumerate();
    let profile = |(number, way): (usize, &&WayRows)| profile_section(number, way, &suspect(way));
    let mut sections: Vec<Section> = numbered.map(profile).collect();
    sections.extend(plan_section(ways));
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
    let of = match (runs().min().unwrap_or(0), runs().max().unwrap_or(0)) {
        (1, 1) => "1 run".to_owned(),
        (least, most) if least == most => format!("{most} runs"),
        (least, most) => format!("{least} to {most} runs"),
    };
    let mut words = format!(
        "{:.1} km, {of}; the grade is known within {:.2} % (1 sigma, median).",
        km(rows.len()),
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

/// Returns the section of the plan; `None` where no cell has a position.
fn plan_section(ways: &[WayRows]) -> Option<Section> {
    let placed = placed(ways);
    let rows = || placed.iter().flat_map(|way| &way.rows);
    let middle = rows().nth(rows().count() / 2)?;
    let directions = if ways.len() > 1 {
        " Each way is drawn slightly to the right of its position."
    } else {
        ""
    };
    let caption = format!(
        "From above, north up. Grade in the direction of travel; uphill is positive.{directions} A \
         point under the pointer shows in the profile, and the other way round."
    );
    let (latitude, longitude) = (middle.latitude_deg, middle.longitude_deg);
    let url = format!(
        "https://www.openstreetmap.org/?mlat={latitude:.5}&mlon={longitude:.5}#map=13/{latitude:.5}/{longitude:.5}"
    );
    let figure = Figure::plan("plan", plan(&placed), caption);
    let figure = figure.with_link(url, "Open its middle on openstreetmap.org.");
    Some(Section::new("Plan").figure(figure))
}

/// Returns the ways with the cells that have a position: all of them in a map, some in a run.
fn placed(ways: &[WayRows]) -> Cow<'_, [WayRows]> {
    let is_placed = |row: &MapRow| row.latitude_deg.is_finite() && row.longitude_deg.is_finite();
    if ways.iter().flat_map(|way| &way.rows).all(is_placed) {
        return ways.into();
    }
    let part = |way: &WayRows| WayRows {
        name: way.name.clone(),
        rows: way
            .rows
            .iter()
            .filter(|row| is_placed(row))
            .cloned()
            .collect(),
    };
    ways.iter().map(part).collect()
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

/// Returns the profiles of a way: altitude, grade with two sigmas, and the number of runs if it is not
/// always one. The number makes the names of its figures distinct. `suspect` are stretches to shade, km.
#[must_use]
pub fn profile_section(number: usize, way: &WayRows, suspect: &[(f64, f64)]) -> Section {
    let profile = |y_label, name, colour, value: fn(&MapRow) -> (f64, Option<f64>)| {
        let points = way.rows.iter().map(|row| {
            let (value, sigma) = value(row);
            ProfilePoint {
                distance_m: row.distance_m,
                value,
                sigma,
            }
        });
        let mut plot = Plot::profile(y_label, link(way)).with_profile(name, colour, points);
        plot.shaded = suspect.to_vec();
        plot
    };
    let figure = |name: &str, plot: &Plot, caption: &str| {
        Figure::new(format!("{name}_{number}"), plot, caption)
    };
    let heading = way
        .name
        .as_ref()
        .map_or_else(|| "Along the road".to_owned(), |name| format!("Way {name}"));
    let mut section = Section::new(heading);
    if way.rows.iter().any(|row| row.altitude_m.is_some()) {
        let mut altitude = profile("altitude (m)", "altitude", colour::BLACK, |row| {
            (row.altitude_m.unwrap_or(f64::NAN), None)
        });
        altitude.height = 180;
        section = section.figure(figure("altitude", &altitude, ""));
    }
    let grade = profile("grade (%)", "grade", colour::BLUE, |row| {
        (row.grade_percent, Some(row.grade_sigma_percent))
    });
    let caption = if suspect.is_empty() {
        "Grade in the direction of travel. A gap has no run."
    } else {
        "Grade in the direction of travel. A gap has no run. Grey: signals of a run disagree there."
    };
    section = section.figure(figure("grade", &grade, caption));
    let most = way.rows.iter().map(|row| row.runs).max().unwrap_or(0);
    if most > 1 {
        let mut runs = profile("runs", "runs", colour::BLACK, |row| {
            (f64::from(row.runs), None)
        });
        (runs.y_range, runs.height) = (Some((0.0, 1.1 * f64::from(most))), 160);
        section = section.figure(figure("runs", &runs, "Number of runs."));
    }
    section
}
