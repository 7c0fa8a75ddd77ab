//! `roadgrade demo`: the main job from end to end, on a built-in scenario.

use super::estimate::Additions;
use super::tuning_option::TuningOption;
use super::{estimate, outputs};
use crate::error::{Error, Result, on_one_line};
use crate::files::csv::write_csv;
use crate::files::oracle::{OracleFile, mean_speed_mps};
use crate::files::run::{self, RunCell};
use crate::files::truth;
use crate::files::vehicle::VehicleFile;
use crate::logs_to_map::{Job, drives, make};
use crate::map::{self, GradeMap, MapRow, Network, RoadLine, RoadRow, SessionRun};
use crate::recorder::check_inputs;
use crate::report::demo_page::{Demo, DemoDrive, demo_page};
use crate::score::{self, ScoreRow, Unscorable, rivals};
use crate::simulator::scenario::Scenario;
use crate::simulator::{files_of, write_runs};
use crate::source::read_options::ReadOptions;
use crate::terminal::print::{note, print};
use estimator_core::Tuning;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Folder, and name in the table, of the map that is made without vehicle files.
const FROM_LOGS: &str = "from_logs";

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder for the logs, runs, map, scores and the page.
    #[arg(long, value_name = "DIR", default_value = "roadgrade-demo")]
    out: PathBuf,
    #[command(flatten)]
    tuning: TuningOption,
    /// Print the scores as JSON instead of a table.
    #[arg(long, hide_short_help = true)]
    json: bool,
}

impl Args {
    fn check_outputs(&self, written: &[PathBuf]) -> Result<()> {
        let written = written.iter().map(PathBuf::as_path);
        outputs::check(self.tuning.file(), written)
    }
}

/// Returns the files of the command, except those of the page.
fn written(scenario: &Scenario, folder: &Path) -> Vec<PathBuf> {
    let runs = scenario.runs.iter().map(|run| format!("{}.csv", run.name));
    let tables = ["map.csv", "score.csv"].map(str::to_owned);
    let mut files = files_of(scenario, folder);
    files.extend(runs.chain(tables).map(|name| folder.join(name)));
    files
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let tuning = args.tuning.read()?;
    let scenario = Scenario::builtin();
    let out = &args.out;
    args.check_outputs(&written(&scenario, out))?;
    note("1  simulate trucks; their true parameters differ from their files");
    for run in write_runs(&scenario, out)? {
        note(format_args!("{run}"));
    }
    note("2  estimate each drive from its bus log");
    let road = TrueRoad::read(out)?;
    let drives = (0..scenario.runs.len())
        .into_par_iter()
        .map(|index| drive(&scenario, index, &tuning, &road, out))
        .collect::<Result<Vec<_>>>()?;
    note("3  fuse the runs into a map");
    let map = fuse(&drives, &road, out)?;
    note("4  score against the truth and write the page");
    let (true_percent, map_score) = road.score(&map)?;
    let mut scores: Vec<ScoreRow> = drives.iter().flat_map(|d| d.scores.clone()).collect();
    let mut overall = score::mean(&scores);
    overall.push(map_score);
    scores.extend_from_slice(&overall);
    note("5  map truck A's roads again from its logs alone, without a vehicle file");
    let from_logs = map_from_logs(&scenario, &tuning, &road, out)?;
    overall.push(from_logs);
    let demo = Demo {
        drives,
        map,
        true_percent,
        road: road.rows,
        scores,
    };
    let page = demo_page(&demo);
    args.check_outputs(&page.files(out))?;
    let report = page.write(out)?;
    let table = out.join("score.csv");
    write_csv(&table, demo.scores.iter().map(ScoreRow::rounded))?;
    if args.json {
        return print(&format!("{}\n", score::json(&overall)));
    }
    print(&format!("{}\n\n", score::table(&overall)))?;
    print(&format!("each run: {}\n", on_one_line(&table)))?;
    let from_logs = out.join(FROM_LOGS);
    print(&format!(
        "from logs alone: {}\n",
        on_one_line(&from_logs.join("index.html"))
    ))?;
    print(&format!("page to open: {}\n", on_one_line(&report)))
}

/// Makes a map of the logs of truck A, whose vehicle is identified, and scores it.
fn map_from_logs(
    scenario: &Scenario,
    tuning: &Tuning,
    road: &TrueRoad,
    folder: &Path,
) -> Result<ScoreRow> {
    let first = &scenario.runs[0].vehicle.name;
    let logs: Vec<PathBuf> = scenario
        .runs
        .iter()
        .filter(|run| run.vehicle.name == *first)
        .map(|run| folder.join(format!("{}.log", run.name)))
        .collect();
    let made = make(
        Job {
            drives: drives(&logs, false),
            vehicle: None,
            like: None,
            roads: Some(TrueRoad::read(folder)?.network),
            tuning: tuning.clone(),
            options: ReadOptions::default(),
            keep_suspect: false,
        },
        |_| (),
    )?;
    made.write(&folder.join(FROM_LOGS))?;
    let rows: Vec<MapRow> = made.ways.iter().flat_map(|way| way.rows.clone()).collect();
    let (_, mut row) = road.score(&rows)?;
    FROM_LOGS.clone_into(&mut row.run);
    Ok(row)
}

/// The road of the scenario, with its true grades.
struct TrueRoad {
    file: PathBuf,
    rows: Vec<RoadRow>,
    network: Network,
}

impl TrueRoad {
    fn read(folder: &Path) -> Result<Self> {
        let file = folder.join("road.csv");
        let rows: Vec<RoadRow> = map::read_road(&file)?;
        let line = RoadLine::new(rows.iter().map(RoadRow::point).collect())
            .map_err(|e| Error::content(&file, e.to_string()))?;
        Ok(Self {
            file,
            rows,
            network: Network::from(line),
        })
    }

    /// Returns the true grade at each cell of the map, and the score of the map.
    fn score(&self, map: &[MapRow]) -> Result<(Vec<Option<f64>>, ScoreRow)> {
        let problem = |e: Unscorable| Error::content(&self.file, e.to_string());
        let true_percent = score::true_grades(map, &self.rows).map_err(problem)?;
        let mut row = score::score_map_on_road(map, &self.rows).map_err(problem)?;
        row.run = "all".to_owned();
        Ok((true_percent, row))
    }
}

fn drive(
    scenario: &Scenario,
    index: usize,
    tuning: &Tuning,
    road: &TrueRoad,
    folder: &Path,
) -> Result<DemoDrive> {
    let run = &scenario.runs[index];
    let file = |ending: &str| folder.join(format!("{}.{ending}", run.name));
    let log = file("log");
    let vehicle = VehicleFile::read(&file("vehicle.toml"))?;
    let options = ReadOptions::default();
    let none = Additions::default();
    let estimated = estimate::drive::<f32>(&vehicle, tuning, None, none, &log, &options)?;
    check_inputs(&log, &vehicle, &estimated, &options)?;
    let rows = estimated.in_memory()?.rows;
    run::write(&file("csv"), &rows)?;
    let truth = truth::read(&file("truth.csv"))?;
    let oracle = OracleFile::read(&file("oracle.toml"))?;
    let rivals = rivals::of_log(&log, Some(&vehicle), Some(&oracle), mean_speed_mps(&rows))?;
    let scored = score::score_run_beside(&run.name, &rows, &truth, &rivals)
        .map_err(|e| Error::content(&log, e.to_string()))?;
    let cells: Vec<RunCell> = rows.iter().map(RunCell::from).collect();
    Ok(DemoDrive {
        name: run.name.clone(),
        truck: vehicle.name,
        places_m: map::road_distances(&road.network, &cells),
        rows,
        truth,
        scores: scored.rows,
        true_scale: run.true_scale(),
    })
}

fn fuse(drives: &[DemoDrive], road: &TrueRoad, folder: &Path) -> Result<Vec<MapRow>> {
    let mut fused = GradeMap::new(&road.network);
    for drive in drives {
        // Each drive has its own parameter errors, so no two drives share a session.
        fused.add_run(&SessionRun {
            session: None,
            rows: &drive.rows,
        });
    }
    let rows = fused.fused().rows();
    map::write_map(&folder.join("map.csv"), &rows)?;
    Ok(rows)
}
