//! The measured city bus: what the estimator makes of real data, and what the bare vehicle model
//! would have made of it.
//!
//! No truth is known. Each pass is judged against the map of the other passes in its direction
//! (which shares the vehicle's errors, not its passes' noise) and against terrain (which shares
//! nothing, but is coarse).

use super::drift::{Drift, ForceSample, vehicle_model_drift};
use super::windows::{GradeProfile, WindowErrors, window_errors};
use crate::error::{Error, Result};
use crate::map::{self, GradeMap, MapRow, RoadLine};
use crate::recorder::estimate_log;
use crate::run_file::RunRow;
use crate::source::terrain::Terrain;
use crate::source::ztbus::{Direction, Mission, Pass, round_trips};
use serde::Serialize;
use std::path::Path;

/// Windows over which grades are compared, m.
pub const WINDOW_M: f64 = 600.0;
/// Base over which the terrain's altitudes become a grade, m.
const TERRAIN_BASE_M: f64 = 200.0;

/// One pass with its errors.
#[derive(Clone, Debug, Serialize)]
pub struct PassErrors {
    /// Number in the mission, from 1.
    pub pass: usize,
    /// Direction in words.
    pub direction: &'static str,
    /// Against the map of the other passes in its direction, over [`WINDOW_M`].
    pub others: Option<WindowErrors>,
    /// Against terrain, over [`WINDOW_M`].
    pub terrain: Option<WindowErrors>,
    /// What the vehicle model was found to read too high, mean over the pass, %.
    pub bias_percent: f64,
    /// Traction scale found at the end.
    pub scale: f64,
}

/// What the study found.
#[derive(Debug)]
pub struct Study {
    /// One for each pass.
    pub passes: Vec<PassErrors>,
    /// Bare vehicle model over each complete round trip.
    pub drifts: Vec<Drift>,
    /// For each direction: terrain, and each pass with its number, as grade over distance.
    pub profiles: Vec<DirectionProfiles>,
}

/// Profiles of the passes in one direction, on one road.
#[derive(Debug)]
pub struct DirectionProfiles {
    /// Direction in words.
    pub direction: &'static str,
    /// Terrain altitude, m, over distance, m.
    pub terrain: Vec<(f64, f64)>,
    /// Pass number, and its grade mapped onto the road.
    pub passes: Vec<(usize, Vec<MapRow>)>,
}

/// Runs the study on a mission and the terrain under it.
///
/// # Errors
/// Files that cannot be read, or a mission without passes over one road.
pub fn study(mission_file: &Path, terrain_folder: &Path) -> Result<Study> {
    let mission = Mission::read(mission_file)?;
    let mut terrain = Terrain::new(terrain_folder);
    let passes = mission.passes();
    let tables = tempfile::tempdir().map_err(Error::io(Path::new("temporary folder")))?;
    let runs = passes
        .iter()
        .map(|pass| estimate(&mission, pass, tables.path()))
        .collect::<Result<Vec<_>>>()?;
    let mut found = Vec::new();
    let mut profiles = Vec::new();
    for direction in [Direction::Outbound, Direction::Inbound] {
        let members: Vec<usize> = (0..passes.len())
            .filter(|&k| passes[k].direction == direction && !runs[k].is_empty())
            .collect();
        let Some(&first) = members.first() else {
            continue;
        };
        let problem = |e: &dyn ToString| Error::content(mission_file, e.to_string());
        let track = map::road_of_run(&runs[first])
            .ok_or_else(|| problem(&"a pass without positions; expected GNSS fixes along it"))?;
        let road = RoadLine::new(track).map_err(|e| problem(&e))?;
        let mut of_direction = DirectionProfiles {
            direction: direction.word(),
            terrain: Vec::new(),
            passes: Vec::new(),
        };
        for &k in &members {
            let own = mapped(&road, &[&runs[k]]);
            let others: Vec<&[RunRow]> = members
                .iter()
                .filter(|&&other| other != k)
                .map(|&other| runs[other].as_slice())
                .collect();
            let ground = ground(&mut terrain, &own)?;
            let estimate = profile(&own);
            found.push(PassErrors {
                pass: k + 1,
                direction: direction.word(),
                others: window_errors(&estimate, &profile(&mapped(&road, &others)), WINDOW_M),
                terrain: window_errors(
                    &estimate,
                    &GradeProfile::from_altitudes(ground.iter().copied(), TERRAIN_BASE_M),
                    WINDOW_M,
                ),
                bias_percent: runs[k].iter().map(|row| row.bias_percent).sum::<f64>()
                    / runs[k].len() as f64,
                scale: runs[k].last().map_or(1.0, |row| row.scale),
            });
            if k == first {
                of_direction.terrain = ground;
            }
            of_direction.passes.push((k + 1, own));
        }
        profiles.push(of_direction);
    }
    found.sort_by_key(|errors| errors.pass);
    Ok(Study {
        passes: found,
        drifts: drifts(&mission, &passes),
        profiles,
    })
}

/// Estimates a pass as a user would: from its signal table.
fn estimate(mission: &Mission, pass: &Pass, folder: &Path) -> Result<Vec<RunRow>> {
    let table = folder.join("pass.csv");
    mission.write_pass(&table, pass)?;
    let vehicle = mission.vehicle().parameters;
    Ok(estimate_log::<f32>(&vehicle, &table, |_| ())?.rows)
}

fn mapped(road: &RoadLine, runs: &[&[RunRow]]) -> Vec<MapRow> {
    let mut grades = GradeMap::new(road);
    for run in runs {
        grades.add_run(run);
    }
    grades.rows()
}

fn profile(rows: &[MapRow]) -> GradeProfile {
    GradeProfile::new(rows.iter().map(|row| (row.distance_m, row.grade_percent)))
}

/// Terrain altitude along a mapped pass.
fn ground(terrain: &mut Terrain, rows: &[MapRow]) -> Result<Vec<(f64, f64)>> {
    let mut ground = Vec::new();
    for row in rows {
        if let Some(altitude_m) = terrain.altitude_m(row.latitude_deg, row.longitude_deg)? {
            ground.push((row.distance_m, altitude_m));
        }
    }
    Ok(ground)
}

fn drifts(mission: &Mission, passes: &[Pass]) -> Vec<Drift> {
    let vehicle = mission.vehicle().parameters;
    round_trips(passes)
        .into_iter()
        .filter_map(|rows| {
            let samples: Vec<ForceSample> = mission.rows()[rows]
                .iter()
                .filter_map(|row| {
                    Some(ForceSample {
                        time_s: row.time_s,
                        speed_mps: row.speed_mps?,
                        traction_force_n: row.traction_force_n?,
                        mass_kg: Some(row.mass_kg()),
                        ambient_celsius: row.ambient_celsius,
                        air_pressure_pa: None,
                    })
                })
                .collect();
            vehicle_model_drift(&samples, &vehicle, 0.0)
        })
        .collect()
}
