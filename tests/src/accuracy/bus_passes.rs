//! A measured bus: each pass over its road beside the map of its other passes, in windows of 600 m.
//! The passes share the errors of the vehicle, so this is the scatter.

use super::errors::{Errors, GradeError};
use super::estimate::Estimate;
use super::run::run;
use super::window_means::WindowMeans;
use crate::image::measured_mission;
use estimator_core::Tuning;
use host_sim::error::{Error, Result};
use host_sim::files::run::RunRow;
use host_sim::map::{GradeMap, Network, RoadLine, SessionRun, road_of_run};
use host_sim::source::read_options::ReadOptions;
use host_sim::source::ztbus::{Mission, Pass, PassDirection};
use rayon::prelude::*;
use std::path::Path;

const WINDOW_M: f64 = 600.0;

/// Judges the passes of the mission.
///
/// # Errors
/// Returns an error if the mission cannot be read, or a pass has no positions.
pub fn judge(tuning: &Tuning) -> Result<Errors> {
    let path = measured_mission();
    let mission = Mission::read(&path)?;
    let passes = mission.passes();
    let runs = passes
        .par_iter()
        .map(|pass| estimated(&mission, pass, tuning, &path));
    let runs: Vec<Vec<RunRow>> = runs.collect::<Result<_>>()?;
    let mut roads = Vec::new();
    for direction in [PassDirection::Outbound, PassDirection::Inbound] {
        let is_of = |(pass, _): &(&Pass, _)| pass.direction == direction;
        let of_direction = passes.iter().zip(&runs).filter(is_of);
        let runs: Vec<&[RunRow]> = of_direction.map(|(_, rows)| &**rows).collect();
        roads.push((road(&runs, &path)?, runs));
    }
    Ok(Errors::new(|estimate| {
        let errors = roads
            .iter()
            .flat_map(|(road, runs)| scatter(road, runs, estimate));
        errors.collect()
    }))
}

fn estimated(mission: &Mission, pass: &Pass, tuning: &Tuning, path: &Path) -> Result<Vec<RunRow>> {
    let scratch = tempfile::tempdir().map_err(Error::io(path))?;
    let table = scratch.path().join("pass.csv");
    mission.write_pass(&table, pass)?;
    run(
        &table,
        &mission.vehicle().model,
        tuning,
        &ReadOptions::default(),
    )
}

/// Returns the road of the first run.
fn road(runs: &[&[RunRow]], path: &Path) -> Result<Network> {
    let track = runs.first().and_then(|rows| road_of_run(rows));
    let track =
        track.ok_or_else(|| Error::content(path, "no positions; expected those of passes"))?;
    let line = RoadLine::new(track).map_err(|error| Error::content(path, error.to_string()))?;
    Ok(Network::from(line))
}

/// Returns the errors of an estimate of each run beside the smoothed map of the others.
fn scatter(road: &Network, runs: &[&[RunRow]], estimate: Estimate) -> Vec<GradeError> {
    let of_run = |(at, rows): (usize, &&[RunRow])| {
        let own: Vec<RunRow> = rows
            .iter()
            .map(|row| with_estimate(row, estimate))
            .collect();
        let own = mapped(road, &[&own]);
        let others: Vec<&[RunRow]> = [&runs[..at], &runs[at + 1..]].concat();
        let others = mapped(road, &others);
        let windows = others.windows(0.0, WINDOW_M);
        let errors = windows.filter_map(|(from_m, to_m)| {
            let (own_percent, own_sigma) = own.mean(from_m, to_m)?;
            let (others_percent, others_sigma) = others.mean(from_m, to_m)?;
            Some(GradeError {
                error_percent: own_percent - others_percent,
                variance: own_sigma.powi(2) + others_sigma.powi(2),
            })
        });
        errors.collect::<Vec<_>>()
    };
    runs.iter().enumerate().flat_map(of_run).collect()
}

/// Returns a cell whose grade is that of the estimate: maps take the smoothed one.
fn with_estimate(row: &RunRow, estimate: Estimate) -> RunRow {
    let (grade_percent, grade_sigma_percent) = estimate.of(row);
    RunRow {
        grade_percent,
        grade_sigma_percent,
        ..*row
    }
}

/// Fuses runs into a map of the road.
fn mapped(road: &Network, runs: &[&[RunRow]]) -> WindowMeans {
    let mut map = GradeMap::new(road);
    for rows in runs {
        map.add_run(&SessionRun {
            session: Some("bus"),
            rows,
        });
    }
    let rows = map.fused().rows().into_iter();
    WindowMeans::new(rows.map(|row| (row.distance_m, (row.grade_percent, row.grade_sigma_percent))))
}
