//! `roadgrade demo`: the main job from end to end, on a built-in scenario.

use super::estimate;
use crate::error::{Error, Result};
use crate::files::csv::write_csv;
use crate::files::oracle::{OracleFile, mean_speed_mps};
use crate::files::run::{self, RunRow};
use crate::files::truth::{self, TruthRow};
use crate::files::vehicle::VehicleFile;
use crate::map::{self, GradeMap, MapRow, Network, RoadLine, RoadRow, SessionRun};
use crate::numeric::series::linear;
use crate::report::page::{Figure, Page, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::score::{self, ScoreRow, rivals};
use crate::simulator::scenario::Scenario;
use crate::simulator::write_runs;
use crate::terminal::print::print;
use std::path::{Path, PathBuf};

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Where logs, runs, map, scores and the page go.
    #[arg(long, value_name = "DIR", default_value = "roadgrade-demo")]
    out: PathBuf,
}

/// One drive of the scenario, simulated and estimated.
struct Drive {
    name: String,
    truck: String,
    rows: Vec<RunRow>,
    truth: Vec<TruthRow>,
    scores: Vec<ScoreRow>,
    true_scale: f64,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let scenario = Scenario::builtin();
    let out = &args.out;
    eprintln!("1  simulate trucks whose parameters are not those of their files");
    write_runs(&scenario, out)?;
    eprintln!("2  estimate each drive from its bus log");
    let drives = (0..scenario.runs.len())
        .map(|index| drive(&scenario, index, out))
        .collect::<Result<Vec<_>>>()?;
    eprintln!("3  fuse the runs into a map");
    let (map, map_score) = fuse(&drives, out)?;
    eprintln!("4  score against the truth, draw the page");
    let mut scores: Vec<ScoreRow> = drives.iter().flat_map(|d| d.scores.clone()).collect();
    let mut overall = score::mean(&scores);
    overall.push(map_score);
    scores.extend_from_slice(&overall);
    let report = page(&drives, &map, &scores).write(out)?;
    let table = out.join("score.csv");
    write_csv(&table, scores.iter().map(ScoreRow::rounded))?;
    print(&format!("{}\n\n", score::table(&overall)))?;
    print(&format!("each run: {}\n", table.display()))?;
    print(&format!("page to open: {}\n", report.display()))
}

fn drive(scenario: &Scenario, index: usize, folder: &Path) -> Result<Drive> {
    let run = &scenario.runs[index];
    let file = |ending: &str| folder.join(format!("{}.{ending}", run.name));
    let log = file("log");
    let vehicle = VehicleFile::read(&file("vehicle.toml"))?;
    let estimated = estimate::drive::<f32>(&vehicle, None, &log)?;
    estimate::check(&log, &vehicle, &estimated)?;
    let rows = estimated.in_memory()?.rows;
    run::write(&file("csv"), &rows)?;
    let truth = truth::read(&file("truth.csv"))?;
    let oracle = OracleFile::read(&file("oracle.toml"))?;
    let rivals = rivals::of_log(&log, Some(&vehicle), Some(&oracle), mean_speed_mps(&rows))?;
    let scored = score::score_run_beside(&run.name, &rows, &truth, &rivals)
        .map_err(|e| Error::content(&log, e.to_string()))?;
    Ok(Drive {
        name: run.name.clone(),
        truck: vehicle.name,
        rows,
        truth,
        scores: scored.rows,
        true_scale: run.true_scale(),
    })
}

fn fuse(drives: &[Drive], folder: &Path) -> Result<(Vec<MapRow>, ScoreRow)> {
    let road_file = folder.join("road.csv");
    let reference: Vec<RoadRow> = map::read_road(&road_file)?;
    let problem = |e: &dyn ToString| Error::content(&road_file, e.to_string());
    let road =
        RoadLine::new(reference.iter().map(RoadRow::point).collect()).map_err(|e| problem(&e))?;
    let road = Network::from(road);
    let mut fused = GradeMap::new(&road);
    for drive in drives {
        // The errors of every drive's parameters are its own: no two are of one session.
        fused.add_run(&SessionRun {
            session: None,
            rows: &drive.rows,
        });
    }
    let rows = fused.fused().rows();
    map::write_map(&folder.join("map.csv"), &rows)?;
    let mut row = score::score_map_on_road(&rows, &reference).map_err(|e| problem(&e))?;
    row.run = "all".to_owned();
    Ok((rows, row))
}

fn page(drives: &[Drive], map: &[MapRow], scores: &[ScoreRow]) -> Page {
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
               resistance and torque are up to 10 % off what their files say. Everything below \
               was estimated from their CAN logs by the code that runs on the vehicle."
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
                        "What each run is off, smoothed over the whole run.",
                    ),
                ],
            },
            Section {
                heading: "How far off".to_owned(),
                words: vec![
                    "Root of the mean squared error, bias and mean normalised squared error \
                     (NEES; 1 means that the stated sigmas are honest) in % grade, first and last \
                     500 m left out. Live is what the vehicle knows at once, lagged what it knows \
                     500 m later, smoothed what the whole run tells."
                        .to_owned(),
                    "Beside them, from the same logs: the thesis's original filter, its modified \
                     method, and an oracle, which is this filter told the true vehicle and how \
                     large every noise is. These drives have neither wind nor cold tyres, so that \
                     an oracle's vehicle model is exact. The last column is the error over the \
                     oracle's."
                        .to_owned(),
                ],
                tables: vec![
                    Table::new(
                        "errors_table",
                        "Each run, their mean, and the map of all.",
                        &score::HEADER,
                    )
                    .with_rows(score::text(scores)),
                ],
                figures: Vec::new(),
            },
            Section {
                heading: "What the vehicles were found to be".to_owned(),
                words: vec![
                    "The traction scale is true over believed traction per kilogram, found on the \
                     way from GNSS and the vehicle model together."
                        .to_owned(),
                ],
                tables: vec![scales(drives)],
                figures: vec![Figure::new(
                    "altitude",
                    &altitude,
                    "Altitude: GNSS gives its level, with metres of slow error that the runs do \
                     not share.",
                )],
            },
        ],
    }
}

fn error_of(drive: &Drive) -> Vec<(f64, f64)> {
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

fn scales(drives: &[Drive]) -> Table {
    let header = [
        "run",
        "truck",
        "scale found",
        "true scale",
        "mean bias found %",
    ];
    Table::new("scales", "Found at the end of each run.", &header).with_rows(drives.iter().map(
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
