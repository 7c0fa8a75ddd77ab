//! The measured city bus: results of the estimator on real data, and of the bare vehicle model.
//!
//! The truth is unknown. Each pass is judged against the map of the other passes in its direction
//! (which shares the vehicle's errors, but not the noise of its passes) and against terrain (which
//! shares no error, but is coarse).

use super::definition::{Setting, Study, StudyOutcome};
use super::drift::{ForceSample, ModelDrift, vehicle_model_drift};
use super::windows::{GradeProfile, WindowErrors, window_errors};
use crate::error::{Error, Result};
use crate::files::run::RunRow;
use crate::map::{self, GradeMap, MapRow, Network, RoadLine, SessionRun};
use crate::recorder::estimate_log;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use crate::source::read_options::ReadOptions;
use crate::source::terrain::Terrain;
use crate::source::ztbus::{Mission, Pass, PassDirection, round_trips};
use estimator_core::Tuning;
use std::fs;
use std::path::{Path, PathBuf};

/// Length of the windows over which grades are compared, m.
const WINDOW_M: f64 = 600.0;
/// Distance over which the terrain's altitudes become a grade, m.
const TERRAIN_BASE_M: f64 = 200.0;

/// One pass with its errors.
#[derive(Clone, Debug)]
struct PassErrors {
    /// Number of the pass in the mission, from 1.
    pass: usize,
    /// Direction in words.
    direction: &'static str,
    /// Against the map of the other passes in its direction, over [`WINDOW_M`].
    others: Option<WindowErrors>,
    /// Against terrain, over [`WINDOW_M`].
    terrain: Option<WindowErrors>,
    /// Estimated bias of the vehicle model, mean over the pass, %; positive if it reads too high.
    bias_percent: f64,
    /// Estimated traction scale at the end.
    scale: f64,
}

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "ztbus",
    about: "a measured city bus: passes against each other and terrain, drift of the bare model",
    run,
};

/// Result of the study.
#[derive(Debug)]
struct Findings {
    /// Errors of each pass.
    passes: Vec<PassErrors>,
    /// Drift of the bare vehicle model over each complete round trip.
    drifts: Vec<ModelDrift>,
    /// Profiles of each direction: terrain, and each pass with its number.
    profiles: Vec<DirectionProfiles>,
}

/// Profiles of the passes in one direction, on one road.
#[derive(Debug)]
pub(super) struct DirectionProfiles {
    /// Direction in words.
    pub(super) direction: &'static str,
    /// Terrain altitude, m, over distance, m.
    pub(super) terrain: Vec<(f64, f64)>,
    /// Pass number, and its grade on the distances of the road.
    pub(super) passes: Vec<(usize, Vec<MapRow>)>,
}

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let Some(mission) = mission_file(&setting.data) else {
        return Ok(StudyOutcome::Skipped(
            "no ztbus/*.csv in it; expected a mission of the ZTBus data set (--data DIR)"
                .to_owned(),
        ));
    };
    let found = find(&mission, &setting.data.join("srtm"))?;
    Ok(StudyOutcome::Done(section(&found)))
}

/// Returns the profiles of the first mission of the data folder; `None` without one.
pub(super) fn profiles(data: &Path) -> Result<Option<Vec<DirectionProfiles>>> {
    let found = mission_file(data).map(|mission| find(&mission, &data.join("srtm")));
    Ok(found.transpose()?.map(|found| found.profiles))
}

/// Returns the first mission of the data folder, by name.
pub(super) fn mission_file(data: &Path) -> Option<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(data.join("ztbus"))
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "csv"))
        .collect();
    files.sort();
    files.into_iter().next()
}

fn find(mission_file: &Path, terrain_folder: &Path) -> Result<Findings> {
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
    for direction in [PassDirection::Outbound, PassDirection::Inbound] {
        let members: Vec<usize> = (0..passes.len())
            .filter(|&k| passes[k].direction == direction && !runs[k].is_empty())
            .collect();
        let Some(&first) = members.first() else {
            continue;
        };
        let problem = |e: &dyn ToString| Error::content(mission_file, e.to_string());
        let track = map::road_of_run(&runs[first])
            .ok_or_else(|| problem(&"a pass without positions; expected GNSS fixes along it"))?;
        let road = Network::from(RoadLine::new(track).map_err(|e| problem(&e))?);
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
    Ok(Findings {
        passes: found,
        drifts: drifts(&mission, &passes),
        profiles,
    })
}

/// Estimates a pass from its signal table, as a user would.
fn estimate(mission: &Mission, pass: &Pass, folder: &Path) -> Result<Vec<RunRow>> {
    let table = folder.join("pass.csv");
    mission.write_pass(&table, pass)?;
    let model = mission.vehicle().model;
    let run = estimate_log::<f32>(
        &model,
        &Tuning::default(),
        None,
        &table,
        &ReadOptions::default(),
        |_| (),
    )?;
    Ok(run.in_memory()?.rows)
}

fn mapped(road: &Network, runs: &[&[RunRow]]) -> Vec<MapRow> {
    let mut grades = GradeMap::new(road);
    for rows in runs {
        grades.add_run(&SessionRun {
            session: Some("bus"),
            rows,
        });
    }
    grades.fused().rows()
}

fn profile(rows: &[MapRow]) -> GradeProfile {
    GradeProfile::new(rows.iter().map(|row| (row.distance_m, row.grade_percent)))
}

/// Returns the terrain altitude along a mapped pass.
fn ground(terrain: &mut Terrain, rows: &[MapRow]) -> Result<Vec<(f64, f64)>> {
    let mut ground = Vec::new();
    for row in rows {
        if let Some(altitude_m) = terrain.altitude_m(row.latitude_deg, row.longitude_deg)? {
            ground.push((row.distance_m, altitude_m));
        }
    }
    Ok(ground)
}

fn drifts(mission: &Mission, passes: &[Pass]) -> Vec<ModelDrift> {
    let model = mission.vehicle().model;
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
            vehicle_model_drift(&samples, &model.vehicle, 0.0)
        })
        .collect()
}

fn section(found: &Findings) -> Section {
    Section {
        heading: "A measured city bus".to_owned(),
        words: vec![
            "Articulated trolleybus, 19 t empty, on a hilly city route; speed, traction force and \
             raw GNSS once a second. No reference grade exists. Passes are compared with the map \
             of the other passes in their direction, which share the vehicle's own errors, and \
             with radar terrain, which shares none but includes roofs and trees."
                .to_owned(),
        ],
        tables: vec![pass_table(&found.passes), drift_table(&found.drifts)],
        figures: found.profiles.iter().map(altitude_figure).collect(),
        ..Section::default()
    }
}

fn pass_table(passes: &[PassErrors]) -> Table {
    let header = [
        "pass",
        "against other passes: RMSE %",
        "bias %",
        "against terrain: RMSE %",
        "bias %",
        "model bias found %",
        "scale found",
    ];
    let both = |errors: &Option<WindowErrors>| match errors {
        Some(e) => [
            format!("{:.3}", e.rmse_percent),
            format!("{:+.3}", e.bias_percent),
        ],
        None => ["-".to_owned(), "-".to_owned()],
    };
    let caption = format!("Mean grades over windows of {WINDOW_M} m.");
    Table::new("ztbus_passes", caption, &header).with_rows(passes.iter().map(|pass| {
        let mut row = vec![format!("{} {}", pass.pass, pass.direction)];
        row.extend(both(&pass.others));
        row.extend(both(&pass.terrain));
        row.push(format!("{:+.3}", pass.bias_percent));
        row.push(format!("{:.3}", pass.scale));
        row
    }))
}

fn drift_table(drifts: &[ModelDrift]) -> Table {
    let header = [
        "round trip",
        "length km",
        "drift m/km",
        "mean grade error %",
    ];
    let caption = "Altitude that the bare vehicle model (eq. 9) gains over complete round trips, \
                   which end where they began, with the published parameters of this bus. Nothing \
                   is fitted: any gain is an error of the model.";
    Table::new("ztbus_drift", caption, &header).with_rows(drifts.iter().zip(1..).map(
        |(drift, number)| {
            vec![
                number.to_string(),
                format!("{:.2}", drift.length_m * 1e-3),
                format!("{:+.2}", drift.drift_m_per_km),
                format!("{:+.3}", drift.grade_error_percent),
            ]
        },
    ))
}

fn altitude_figure(profiles: &DirectionProfiles) -> Figure {
    let terrain = profiles.terrain.iter().map(|(x, z)| (x * 1e-3, *z));
    let mut plot = Plot::new("distance (km)", "altitude (m)")
        .with(Series::line("terrain", colour::BLACK, terrain).drawn(Mark::Dashed));
    for ((number, rows), colour) in profiles.passes.iter().zip(colour::CYCLE) {
        let altitude = rows
            .iter()
            .filter_map(|row| Some((row.distance_m * 1e-3, row.altitude_m?)));
        plot = plot.with(Series::line(format!("pass {number}"), colour, altitude));
    }
    let direction = profiles.direction;
    Figure::new(
        format!("ztbus_{direction}"),
        &plot,
        format!(
            "Estimated altitude, {direction} passes. GNSS gives the level, with metres of slow \
             error in each pass."
        ),
    )
}
