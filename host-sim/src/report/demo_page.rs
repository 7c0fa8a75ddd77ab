//! The page of the demonstration.

use super::map_page;
use super::page::{Figure, Page, Section, Table};
use super::plot::{Mark, Plot, Series, colour, shaded_ranges};
use super::profile::ProfilePoint;
use crate::files::run::RunRow;
use crate::files::truth::TruthRow;
use crate::map::{MapRow, RoadRow, WayRows};
use crate::numeric::series::linear;
use crate::score::{self, ScoreRow};

/// Name of what all figures run along, as in the page of a map.
const ROAD: &str = "road";

/// What the demonstration found.
#[derive(Clone, Debug)]
pub struct Demo {
    /// The drives.
    pub drives: Vec<DemoDrive>,
    /// The map of all of them.
    pub map: Vec<MapRow>,
    /// True grade at each cell of the map, %, as the score compares it.
    pub true_percent: Vec<Option<f64>>,
    /// The true road.
    pub road: Vec<RoadRow>,
    /// The error table.
    pub scores: Vec<ScoreRow>,
}

/// One drive of the scenario, simulated and estimated.
#[derive(Clone, Debug)]
pub struct DemoDrive {
    /// Name of the run.
    pub name: String,
    /// Name of its vehicle.
    pub truck: String,
    /// Its estimate.
    pub rows: Vec<RunRow>,
    /// Distance of each row along the road, m. The odometer differs from it by metres.
    pub places_m: Vec<Option<f64>>,
    /// Its truth.
    pub truth: Vec<TruthRow>,
    /// Its lines of the error table.
    pub scores: Vec<ScoreRow>,
    /// True over assumed traction per kilogram.
    pub true_scale: f64,
}

/// Creates the page.
#[must_use]
pub fn demo_page(demo: &Demo) -> Page {
    Page::new(
        "A grade map from CAN data",
        "Five drives over the same ten kilometres, by two trucks whose mass, drag, rolling \
         resistance and torque differ by up to 10 % from their vehicle files. All results \
         below are estimated from their CAN logs by the code that runs on the vehicle.",
    )
    .with(road_section(demo))
    .with(errors_section(demo))
    .with(vehicles_section(demo))
}

fn road_section(demo: &Demo) -> Section {
    let way = WayRows {
        name: None,
        rows: demo.map.clone(),
    };
    let plan = map_page::plan(&[way]);
    Section::new("Grade along the road")
        .paragraph("The five runs fused, each weighted by its variance.")
        .figure(Figure::new(
            "map_grade",
            &map_plot(demo),
            "Fused map against the truth, both at the cells of the map.",
        ))
        .figure(Figure::plan(
            "plan",
            plan,
            "The map from above, north up. A point under the pointer shows in all figures.",
        ))
        .figure(errors_figure(demo))
}

fn map_plot(demo: &Demo) -> Plot {
    let map = demo.map.iter().map(|row| ProfilePoint {
        distance_m: row.distance_m,
        value: row.grade_percent,
        sigma: Some(row.grade_sigma_percent),
    });
    let truth = demo.map.iter().zip(&demo.true_percent);
    let truth = truth.map(|(row, percent)| (row.distance_m * 1e-3, percent.unwrap_or(f64::NAN)));
    let mut plot = Plot::profile("grade (%)", ROAD)
        .with(Series::line("true grade", colour::BLACK, truth))
        .with_profile("map of all runs", colour::BLUE, map);
    // The truth is seen through the dashes, and the band is behind both.
    plot.series.swap(0, 1);
    if let Some(line) = plot.series.last_mut() {
        line.mark = Mark::Dashed;
    }
    plot
}

fn errors_figure(demo: &Demo) -> Figure {
    let mut plot = Plot::profile("error of smoothed grade (%)", ROAD);
    plot.y_range = Some((-0.5, 0.5));
    plot.shaded = demo.drives.iter().flat_map(suspect_ranges).collect();
    for (drive, colour) in demo.drives.iter().zip(colour::CYCLE) {
        plot = plot.with(Series::line(drive.title(), colour, drive.errors()));
    }
    let mut caption = "Error of each run, smoothed over the whole run.".to_owned();
    if !plot.shaded.is_empty() {
        caption += " Grey: signals disagree in some run.";
    }
    Figure::new("errors", &plot, caption)
}

fn errors_section(demo: &Demo) -> Section {
    Section::new("How far off")
        .paragraph(
            "Root of the mean squared error, bias and mean normalised squared error \
             (NEES; 1 means that the stated sigmas are consistent) in % grade, first and \
             last 500 m left out. Live is the grade on the vehicle at once, lagged the \
             grade on the vehicle 500 m later, smoothed the grade from the whole run.",
        )
        .paragraph(
            "For comparison, from the same logs: the thesis's original filter, its \
             modified method, and an oracle. The oracle is this filter with the true \
             vehicle parameters and the true noise levels. These drives have neither wind \
             nor cold tyres, so the oracle's vehicle model is exact. The last column is \
             the error over the oracle's.",
        )
        .table(
            Table::new(
                "errors_table",
                "Each run, the mean of the runs, and the map of all.",
                &score::HEADER,
            )
            .with_rows(score::text(&demo.scores)),
        )
}

fn vehicles_section(demo: &Demo) -> Section {
    let mut plot = Plot::profile("altitude (m)", ROAD);
    for (drive, colour) in demo.drives.iter().zip(colour::CYCLE) {
        let altitudes = drive.along(|row| row.altitude_m);
        plot = plot.with(Series::line(drive.title(), colour, altitudes));
    }
    let truth = demo.road.iter();
    let truth = truth.filter_map(|row| Some((row.distance_m * 1e-3, row.altitude_m?)));
    let plot = plot.with(Series::line("truth", colour::BLACK, truth));
    Section::new("What the vehicles were found to be")
        .paragraph(
            "The traction scale is true over assumed traction per kilogram. The filter \
             estimates it from GNSS and the vehicle model together.",
        )
        .table(scales(&demo.drives))
        .figure(Figure::new(
            "altitude",
            &plot,
            "Altitude. GNSS determines its level, with a slow error of metres that \
             differs between runs.",
        ))
}

impl DemoDrive {
    fn title(&self) -> String {
        format!("{} ({})", self.name, self.truck)
    }

    /// Returns a value along the road, km, where the run lies on it.
    fn along(&self, value: impl Fn(&RunRow) -> Option<f64>) -> Vec<(f64, f64)> {
        let rows = self.rows.iter().zip(&self.places_m);
        rows.filter_map(|(row, place_m)| Some(((*place_m)? * 1e-3, value(row)?)))
            .collect()
    }

    /// Returns the errors of the smoothed grade against the truth at the same time, %.
    fn errors(&self) -> Vec<(f64, f64)> {
        let truth = self.truth.iter();
        let truth: Vec<(f64, f64)> = truth.map(|row| (row.time_s, row.grade_percent)).collect();
        self.along(|row| Some(row.grade_percent - linear(&truth, row.time_s)?))
    }
}

/// Returns where a run is marked as suspect, km.
fn suspect_ranges(drive: &DemoDrive) -> Vec<(f64, f64)> {
    let marks = drive.along(|row| Some(f64::from(row.consistent)));
    shaded_ranges(
        marks
            .into_iter()
            .map(|(km, consistent)| (km, consistent == 0.0)),
    )
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
