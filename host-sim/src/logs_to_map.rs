//! From logs of one vehicle to a map: identify the vehicle, estimate each drive, fuse the runs.

use crate::error::{Error, Result};
use crate::files::data_set::run_name;
use crate::files::output::{Staged, stage_text};
use crate::files::run::{self, RunCell, RunIdentity};
use crate::files::utc::unix_seconds;
use crate::files::vehicle::VehicleFile;
use crate::identify::{Identified, Like, Request, annotated, identify};
use crate::map::pipeline::roads_of_runs::roads_of_runs;
use crate::map::{GradeMap, Network, PlacedRun, WayRows, place, stage_map_ways};
use crate::recorder::{RunSummary, Warning, estimate_logs, missing};
use crate::report::logs_page::{LogRun, LogsMap, logs_page};
use crate::source::read_options::ReadOptions;
use estimator_core::Tuning;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Drives of one vehicle that overlap by less are consecutive, s.
const LEAST_OVERLAP_S: f64 = 5.0;

/// What a map is made of.
pub struct Job {
    /// The drives.
    pub drives: Vec<Drive>,
    /// The vehicle; identified from the drives if `None`.
    pub vehicle: Option<VehicleFile>,
    /// What the vehicle is like, if it is identified.
    pub like: Option<Like>,
    /// The roads; the tracks of the runs if `None`.
    pub roads: Option<Network>,
    /// Tuning of the estimator.
    pub tuning: Tuning,
    /// How logs are read.
    pub options: ReadOptions,
    /// Keep drives that are suspect over most of their length.
    pub keep_suspect: bool,
}

/// One drive.
pub struct Drive {
    /// Name of its run.
    pub name: String,
    /// Its log, or its consecutive parts.
    pub logs: Vec<PathBuf>,
}

/// A map and where it comes from.
pub struct MadeMap {
    vehicle: VehicleFile,
    identified: Option<Identified>,
    network: Network,
    /// The runs as they lie on the network, in their order.
    placed: Vec<PlacedRun>,
    /// The ways of the map.
    pub ways: Vec<WayRows>,
    /// The runs.
    pub runs: Vec<LogRun>,
    /// Why logs were left out, a line each.
    pub left_out: Vec<String>,
    /// What is not plausible about the drives beside each other.
    pub warnings: Vec<Warning>,
}

/// Returns the drives of these logs: one each, or a single one of consecutive parts. Logs of the
/// same name are numbered.
#[must_use]
pub fn drives(logs: &[PathBuf], are_parts: bool) -> Vec<Drive> {
    if are_parts && let Some(first) = logs.first() {
        return vec![Drive {
            name: run_name(first),
            logs: logs.to_vec(),
        }];
    }
    let mut taken = BTreeSet::new();
    let drive = |log: &PathBuf| {
        let plain = run_name(log);
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        let mut names = std::iter::once(plain.clone()).chain(numbered);
        let name = names.find(|name| taken.insert(name.clone()));
        Drive {
            name: name.unwrap_or(plain),
            logs: vec![log.clone()],
        }
    };
    logs.iter().map(drive).collect()
}

/// Returns the files that [`MadeMap::write`] writes.
#[must_use]
pub fn files(folder: &Path, drives: &[Drive]) -> Vec<PathBuf> {
    let own = ["vehicle.toml", "map.csv", "index.html"].map(|name| folder.join(name));
    let runs = drives.iter().map(|drive| run_path(folder, &drive.name));
    own.into_iter().chain(runs).collect()
}

fn run_path(folder: &Path, name: &str) -> PathBuf {
    folder.join("runs").join(format!("{name}.csv"))
}

/// Makes a map. `progress` gets a line for each step.
///
/// # Errors
/// Returns an error, with file and line, if the vehicle cannot be identified, if no log can be
/// estimated, or if no cell of the roads is covered.
pub fn make(job: Job, progress: impl Fn(&str) + Sync) -> Result<MadeMap> {
    let first = job.drives.first().and_then(|drive| drive.logs.first());
    let first = first.cloned().unwrap_or_default();
    let (vehicle, identified) = vehicle(&job, &progress)?;
    progress("estimating the drives");
    let (runs, left_out) = estimate(&job, &vehicle)?;
    progress("fusing the runs");
    let cells: Vec<Vec<RunCell>> = runs
        .iter()
        .map(|run| run.rows.iter().map(RunCell::from).collect())
        .collect();
    let network = job.roads.or_else(|| roads_of_runs(&cells)).ok_or_else(|| {
        let problem = "no positions, nor in any other log: expected NMEA 2000 129025 or 129029 (or \
                       VP, PGN 65267; columns latitude_deg and longitude_deg)";
        Error::content(&first, problem)
    })?;
    let placed: Vec<PlacedRun> = cells.iter().map(|run| place(&network, run)).collect();
    let ways = fuse(&network, &placed, &vehicle.name);
    let warnings = overlaps(&runs);
    if ways.is_empty() {
        let problem = "no cell of the road is covered; expected runs on it, in its direction";
        return Err(Error::content(&first, problem));
    }
    Ok(MadeMap {
        vehicle,
        identified,
        network,
        placed,
        ways,
        runs,
        left_out,
        warnings,
    })
}

/// Returns a warning for each pair of drives that overlap in time, where the logs have absolute times.
fn overlaps(runs: &[LogRun]) -> Vec<Warning> {
    let times = |run: &LogRun| {
        let start = run.reports.first()?.1.start_utc.as_deref()?;
        let start_s = unix_seconds(start)?;
        let end_s = start_s + run.rows.last()?.time_s;
        Some((run.name.clone(), start_s, end_s))
    };
    let mut times: Vec<(String, f64, f64)> = runs.iter().filter_map(times).collect();
    times.sort_by(|a, b| a.1.total_cmp(&b.1));
    let pairs = times.iter().zip(times.iter().skip(1));
    pairs
        .filter_map(|((first, _, end_s), (second, start_s, other_end_s))| {
            let seconds = end_s.min(*other_end_s) - start_s;
            (seconds > LEAST_OVERLAP_S).then(|| {
                Warning::minor(
                    "overlap",
                    format!("{first} and {second} overlap by {seconds:.0} s, so that this part counts twice"),
                    "leave one of both out, or cut it; if they are of two vehicles, map one vehicle at \
                     a time",
                )
            })
        })
        .collect()
}

fn vehicle(job: &Job, progress: &impl Fn(&str)) -> Result<(VehicleFile, Option<Identified>)> {
    if let Some(vehicle) = &job.vehicle {
        return Ok((vehicle.clone(), None));
    }
    let request = Request {
        logs: job.drives.iter().flat_map(|of| of.logs.clone()).collect(),
        like: job.like.clone(),
        tuning: job.tuning.clone(),
        options: job.options.clone(),
    };
    let found = identify(&request, progress)?;
    Ok((found.vehicle.clone(), Some(found)))
}

/// Estimates all drives. Returns the runs, and why the others have none.
fn estimate(job: &Job, vehicle: &VehicleFile) -> Result<(Vec<LogRun>, Vec<String>)> {
    let results: Vec<Result<LogRun>> = job
        .drives
        .par_iter()
        .map(|drive| estimate_one(job, drive, vehicle))
        .collect();
    let (mut runs, mut problems) = (Vec::<LogRun>::new(), Vec::new());
    let mut seen: BTreeMap<RunIdentity, usize> = BTreeMap::new();
    for (drive, result) in job.drives.iter().zip(results) {
        let run = match result {
            Ok(run) => run,
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        // Under another name, format or packing: a drive counts once.
        let identity = RunIdentity::of(run.rows.iter().map(RunCell::from));
        if let Some(&first) = seen.get(&identity) {
            let problem = format!("the same drive as {}", runs[first].name);
            problems.push(Error::content(&drive.logs[0], problem));
            continue;
        }
        if !job.keep_suspect && run.summary.is_mostly_suspect() {
            let verdict = &run.summary.verdict;
            let problem = format!("{verdict}; --keep-suspect keeps it");
            problems.push(Error::content(&drive.logs[0], problem));
            continue;
        }
        seen.insert(identity, runs.len());
        runs.push(run);
    }
    if runs.is_empty() {
        return Err(problems.swap_remove(0));
    }
    Ok((runs, problems.iter().map(ToString::to_string).collect()))
}

fn estimate_one(job: &Job, drive: &Drive, vehicle: &VehicleFile) -> Result<LogRun> {
    let (mut run, reports) =
        estimate_logs::<f32>(&vehicle.model, &job.tuning, &drive.logs, &job.options)?;
    if let Some(problem) = missing(vehicle, &run, &job.options.ignore) {
        return Err(Error::content(&drive.logs[0], problem));
    }
    let summary = RunSummary::new(&mut run)?;
    let run = run.in_memory()?;
    Ok(LogRun {
        name: drive.name.clone(),
        rows: run.rows,
        summary,
        warnings: run.warnings,
        reports,
    })
}

fn fuse(roads: &Network, runs: &[PlacedRun], vehicle: &str) -> Vec<WayRows> {
    let mut sums = GradeMap::new(roads);
    for run in runs {
        // One vehicle: the errors of its parameters are common to all runs.
        sums.add_placed(Some(vehicle), run);
    }
    sums.close_session(vehicle);
    sums.fused().ways
}

impl MadeMap {
    /// Returns how the vehicle was identified; `None` if it was given.
    #[must_use]
    pub const fn identified(&self) -> Option<&Identified> {
        self.identified.as_ref()
    }

    /// Returns the summary of each run, and why other logs have none.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let runs = self.runs.iter();
        let runs: Vec<_> = runs
            .map(|run| serde_json::json!({ "run": run.name, "summary": run.summary }))
            .collect();
        serde_json::json!({
            "runs": runs,
            "left_out": self.left_out,
            "warnings": self.warnings,
        })
    }

    /// Writes `vehicle.toml`, `map.csv`, `index.html` and `runs/NAME.csv`.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let page = logs_page(&LogsMap {
            network: &self.network,
            placed: &self.placed,
            ways: &self.ways,
            runs: &self.runs,
            vehicle: &self.vehicle.name,
            identified: self.identified.as_ref(),
            left_out: &self.left_out,
            warnings: &self.warnings,
        });
        let text = self
            .identified
            .as_ref()
            .map_or_else(|| self.vehicle.to_toml(), annotated::text);
        let staged: [Staged; 3] = [
            stage_text(&folder.join("vehicle.toml"), &text)?,
            stage_map_ways(&folder.join("map.csv"), &self.ways)?,
            page.stage_alone(&folder.join("index.html"))?,
        ];
        for run in &self.runs {
            run::write(&run_path(folder, &run.name), &run.rows)?;
        }
        staged.into_iter().try_for_each(Staged::commit)
    }
}
