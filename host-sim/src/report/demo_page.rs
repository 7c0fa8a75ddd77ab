//! The page of the demonstration.

use super::page::{Figure, Page, Section, Table};
use super::plot::{Mark, Plot, Series, colour, shaded_ranges};
use crate::files::run::RunRow;
use crate::files::truth::TruthRow;
use crate::map::MapRow;
use crate::numeric::series::linear;
use crate::score::{self, ScoreRow};

/// One drive of the scenario, simulated and estimated.
#[derive(Clone, Debug)]
pub struct DemoDrive {
    /// Name of the run.
    pub name: String,
    /// Name of its vehicle.
    pub truck: String,
    /// Its estimate.
    pub rows: Vec<RunRow>,
    /// Its truth.
    pub truth: Vec<TruthRow>,
    /// Its lines of the error table.
    pub scores: Vec<ScoreRow>,
    /// True over assumed traction per kilogram.
    pub true_scale: f64,
}

/// Creates the page.
#[must_use]
pub fn demo_page(drives: &[DemoDrive], map: &[MapRow], scores: &[ScoreRow]) -> Page {
    let truth = |value: fn(&TruthRow) -> f64| {
        let rows = drives[0].truth.iter();
        rows.map(move |row| (row.distance_m * 1e-3, value(row)))
    };
    let grade = Plot::new("distance (km)", "grade (%)")
        .with(Series::two_sigma(
            "map, ± 2 sigma",
            colour::BLUE,
            map.iter().map(|row| {
                (
                    row.distance_m * 1e-3,
                    row.grade_percent,
                    row.grade_sigma_percent,
                )
            }),
        ))
        .with(Series::line(
            "true grade",
            colour::BLACK,
            truth(|row| row.grade_percent),
        ))
        .with(
            Series::line(
                "map of all runs",
                colour::BLUE,
                map.iter()
                    .map(|row| (row.distance_m * 1e-3, row.grade_percent)),
            )
            .drawn(Mark::Dashed),
        );
    let mut errors = Plot::new("distance (km)", "error of smoothed grade (%)");
    errors.y_range = Some((-0.5, 0.5));
    errors.shaded = drives.iter().flat_map(suspect_ranges).collect();
    let mut altitude = Plot::new("distance (km)", "altitude (m)");
    for (drive, colour) in drives.iter().zip(colour::CYCLE) {
        let name = format!("{} ({})", drive.name, drive.truck);
        errors = errors.with(Series::line(&name, colour, error_of(drive)));
        altitude = altitude.with(Series::line(
            &name,
            colour,
            drive
                .rows
                .iter()
                .filter_map(|row| Some((row.distance_m * 1e-3, row.altitude_m?))),
        ));
    }
    let altitude = altitude.with(Series::line(
        "truth",
        colour::BLACK,
        truth(|row| row.altitude_m),
    ));
    Page {
        title: "A grade map from bus traffic".to_owned(),
        lead: "Five drives over the same ten kilometres, by two trucks whose mass, drag, rolling \
               resistance and torque differ by up to 10 % from their vehicle files. All results \
               below are estimated from their CAN logs by the code that runs on the vehicle."
            .to_owned(),
        sections: vec![
            Section {
                heading: "Grade along the road".to_owned(),
                words: vec!["The five runs fused, each weighted by its variance.".to_owned()],
                tables: Vec::new(),
                figures: vec![
                    Figure::new("map_grade", &grade, "Fused map against the truth."),
                    Figure::new(
                        "errors",
                        &errors,
                        "Error of each run, smoothed over the whole run. Grey: signals disagree in \
                         some run.",
                    ),
                ],
            },
            Section {
                heading: "How far off".to_owned(),
                words: vec![
                    "Root of the mean squared error, bias and mean normalised squared error \
                     (NEES; 1 means that the stated sigmas are consistent) in % grade, first and \
                     last 500 m left out. Live is the grade on the vehicle at once, lagged the \
                     grade on the vehicle 500 m later, smoothed the grade from the whole run."
                        .to_owned(),
                    "For comparison, from the same logs: the thesis's original filter, its \
                     modified method, and an oracle. The oracle is this filter with the true \
                     vehicle parameters and the true noise levels. These drives have neither wind \
                     nor cold tyres, so the oracle's vehicle model is exact. The last column is \
                     the error over the oracle's."
                        .to_owned(),
                ],
                tables: vec![
                    Table::new(
                        "errors_table",
                        "Each run, the mean of the runs, and the map of all.",
                        &score::HEADER,
                    )
                    .with_rows(score::text(scores)),
                ],
                figures: Vec::new(),
            },
            Section {
                heading: "What the vehicles were found to be".to_owned(),
                words: vec![
                    "The traction scale is true over assumed traction per kilogram. The filter \
                     estimates it from GNSS and the vehicle model together."
                        .to_owned(),
                ],
                tables: vec![scales(drives)],
                figures: vec![Figure::new(
                    "altitude",
                    &altitude,
                    "Altitude. GNSS determines its level, with a slow error of metres that \
                     differs between runs.",
                )],
            },
        ],
    }
}

/// Returns where a run is marked as suspect, km.
fn suspect_ranges(drive: &DemoDrive) -> Vec<(f64, f64)> {
    let marks = drive.rows.iter();
    shaded_ranges(marks.map(|row| (row.distance_m * 1e-3, row.consistent == 0)))
}

fn error_of(drive: &DemoDrive) -> Vec<(f64, f64)> {
    let truth: Vec<(f64, f64)> = drive
        .truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    drive
        .rows
        .iter()
        .filter_map(|row| {
            let true_percent = linear(&truth, row.time_s)?;
            Some((row.distance_m * 1e-3, row.grade_percent - true_percent))
        })
        .collect()
}

fn scales(drives: &[DemoDrive]) -> Table {
    let header = [
        "run",
        "truck",
        "scale found",
        "true scale",
        "mean bias found %",
    ];
    Table::new("scales", "Estimates at the end of each run.", &header).with_rows(drives.iter().map(
        |drive| {
            let rows = &drive.rows;
            let mean_bias =
                rows.iter().map(|row| row.bias_percent).sum::<f64>() / rows.len() as f64;
            vec![
                drive.name.clone(),
                drive.truck.clone(),
                format!("{:.3}", rows.last().map_or(1.0, |row| row.scale)),
                format!("{:.3}", drive.true_scale),
                format!("{mean_bias:+.3}"),
            ]
        },
    ))
}
