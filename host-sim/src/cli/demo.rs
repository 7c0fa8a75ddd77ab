//! `roadgrade demo`: the main job from end to end, on a built-in scenario.

use super::tuning_option::TuningOption;
use super::{estimate, outputs};
use crate::error::{Error, Result, on_one_line};
use crate::files::csv::write_csv;
use crate::files::oracle::{OracleFile, mean_speed_mps};
use crate::files::vehicle::VehicleFile;
use crate::files::{run, truth};
use crate::map::{self, GradeMap, MapRow, Network, RoadLine, RoadRow, SessionRun};
use crate::report::demo_page::{DemoDrive, demo_page};
use crate::score::{self, ScoreRow, rivals};
use crate::simulator::scenario::Scenario;
use crate::simulator::{files_of, write_runs};
use crate::terminal::print::{note, print};
use estimator_core::Tuning;
use std::path::{Path, PathBuf};

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder for the logs, runs, map, scores and the page.
    #[arg(long, value_name = "DIR", default_value = "roadgrade-demo")]
    out: PathBuf,
    #[command(flatten)]
    tuning: TuningOption,
    /// Print the scores as JSON instead of a table.
    #[arg(long)]
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
    write_runs(&scenario, out)?;
    note("2  estimate each drive from its bus log");
    let drives = (0..scenario.runs.len())
        .map(|index| drive(&scenario, index, &tuning, out))
        .collect::<Result<Vec<_>>>()?;
    note("3  fuse the runs into a map");
    let (map, map_score) = fuse(&drives, out)?;
    note("4  score against the truth and write the page");
    let mut scores: Vec<ScoreRow> = drives.iter().flat_map(|d| d.scores.clone()).collect();
    let mut overall = score::mean(&scores);
    overall.push(map_score);
    scores.extend_from_slice(&overall);
    let page = demo_page(&drives, &map, &scores);
    args.check_outputs(&page.files(out))?;
    let report = page.write(out)?;
    let table = out.join("score.csv");
    write_csv(&table, scores.iter().map(ScoreRow::rounded))?;
    if args.json {
        return print(&format!("{}\n", score::json(&overall)));
    }
    print(&format!("{}\n\n", score::table(&overall)))?;
    print(&format!("each run: {}\n", on_one_line(&table)))?;
    print(&format!("page to open: {}\n", on_one_line(&report)))
}

fn drive(scenario: &Scenario, index: usize, tuning: &Tuning, folder: &Path) -> Result<DemoDrive> {
    let run = &scenario.runs[index];
    let file = |ending: &str| folder.join(format!("{}.{ending}", run.name));
    let log = file("log");
    let vehicle = VehicleFile::read(&file("vehicle.toml"))?;
    let estimated = estimate::drive::<f32>(&vehicle, tuning, None, &log)?;
    estimate::check(&log, &vehicle, &estimated)?;
    let rows = estimated.in_memory()?.rows;
    run::write(&file("csv"), &rows)?;
    let truth = truth::read(&file("truth.csv"))?;
    let oracle = OracleFile::read(&file("oracle.toml"))?;
    let rivals = rivals::of_log(&log, Some(&vehicle), Some(&oracle), mean_speed_mps(&rows))?;
    let scored = score::score_run_beside(&run.name, &rows, &truth, &rivals)
        .map_err(|e| Error::content(&log, e.to_string()))?;
    Ok(DemoDrive {
        name: run.name.clone(),
        truck: vehicle.name,
        rows,
        truth,
        scores: scored.rows,
        true_scale: run.true_scale(),
    })
}

fn fuse(drives: &[DemoDrive], folder: &Path) -> Result<(Vec<MapRow>, ScoreRow)> {
    let road_file = folder.join("road.csv");
    let reference: Vec<RoadRow> = map::read_road(&road_file)?;
    let problem = |e: &dyn ToString| Error::content(&road_file, e.to_string());
    let road =
        RoadLine::new(reference.iter().map(RoadRow::point).collect()).map_err(|e| problem(&e))?;
    let road = Network::from(road);
    let mut fused = GradeMap::new(&road);
    for drive in drives {
        // Each drive has its own parameter errors, so no two drives share a session.
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
