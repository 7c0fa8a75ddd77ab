//! Writer of the files of a scenario.

use super::recording::Recording;
use super::road_file;
use super::scenario::Scenario;
use crate::error::Result;
use crate::files::output::write_whole;
use crate::files::truth;
use crate::source::candump_writer::write_frame;
use crate::terminal::progress;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Name of the interface in the logs.
const INTERFACE: &str = "can0";

/// A run whose files are written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenRun {
    /// Its name.
    pub run: String,
    /// Name of its vehicle.
    pub vehicle: String,
    /// Length of its road, km.
    pub distance_km: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Number of frames in its log.
    pub frames: u64,
}

impl fmt::Display for WrittenRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: truck {}, {:.1} km in {:.0} s, {} frames",
            self.run, self.vehicle, self.distance_km, self.duration_s, self.frames
        )
    }
}

/// Simulates every run of a scenario and writes its files.
///
/// # Errors
/// Returns an error if a truck gets stuck, or the error of the file system.
pub fn write_runs(scenario: &Scenario, folder: &Path) -> Result<Vec<WrittenRun>> {
    let bar = progress::count(scenario.runs.len() as u64, "runs");
    // Every run is simulated once before the first file is written, so that no file is left if a
    // truck gets stuck. Simulation is fast compared with writing, and a drive is too large to keep.
    let runs = 0..scenario.runs.len();
    runs.clone()
        .into_par_iter()
        .try_for_each(|index| Recording::new(scenario, index).map(drop))?;
    let reports = runs
        .into_par_iter()
        .map(|index| {
            let report = write_run(scenario, index, folder)?;
            bar.inc(1);
            Ok(report)
        })
        .collect::<Result<Vec<_>>>()?;
    road_file::write(&folder.join("road.csv"), &scenario.road)?;
    if let Some(vehicle) = scenario.common_vehicle() {
        vehicle.write(&folder.join("vehicle.toml"))?;
    }
    bar.finish_and_clear();
    Ok(reports)
}

/// Returns the files that [`write_runs`] writes.
#[must_use]
pub fn files_of(scenario: &Scenario, folder: &Path) -> Vec<PathBuf> {
    let endings = ["log", "truth.csv", "vehicle.toml", "oracle.toml"];
    let of_runs = scenario
        .runs
        .iter()
        .flat_map(|run| endings.map(|ending| folder.join(format!("{}.{ending}", run.name))));
    let of_all = ["road.csv", "vehicle.toml"].map(|name| folder.join(name));
    of_runs.chain(of_all).collect()
}

/// Writes the files of one run.
fn write_run(scenario: &Scenario, index: usize, folder: &Path) -> Result<WrittenRun> {
    let run = &scenario.runs[index];
    let recording = Recording::new(scenario, index)?;
    let file = |ending: &str| folder.join(format!("{}.{ending}", run.name));
    let frames = write_log(&file("log"), &recording)?;
    truth::write(&file("truth.csv"), &recording.truth())?;
    run.vehicle.write(&file("vehicle.toml"))?;
    recording.oracle().write(&file("oracle.toml"))?;
    Ok(WrittenRun {
        run: run.name.clone(),
        vehicle: run.vehicle.name.clone(),
        distance_km: 1e-3 * run.length_m,
        duration_s: recording.drive().duration_s(),
        frames,
    })
}

/// Writes the CAN data of the run; returns the number of frames.
fn write_log(path: &Path, recording: &Recording) -> Result<u64> {
    let mut frames = 0;
    write_whole(path, |out| {
        for frame in recording.frames() {
            write_frame(out, &frame, INTERFACE)?;
            frames += 1;
        }
        Ok(())
    })?;
    Ok(frames)
}
