//! Drives over a road with structures, and the errors of maps and terrain on them.

use super::structures::{self, CLAMP_PERCENT, LENGTH_M, Structure};
use crate::error::{Error, Result};
use crate::files::run::RunRow;
use crate::map::{GRID_M, MapRow, RoadProblem, SessionRun, fuse};
use crate::numeric::series::linear;
use crate::numeric::statistics::mean;
use crate::recorder::Recorder;
use crate::simulator::random::{Purpose, stream};
use crate::simulator::road::Road;
use crate::simulator::scenario::Scenario;
use crate::simulator::simulate;
use crate::simulator::truck::Preset;
use crate::study::known_road::KnownRoad;
use crate::study::windows::GradeProfile;
use estimator_core::Tuning;
use rand::RngExt;
use rayon::prelude::*;
use std::fmt::{Display, Write as _};
use std::ops::Range;
use std::path::Path;

/// Name in messages, in place of the scenario's file.
const ORIGIN: &str = "bridges";
/// Streams of the trucks' winds. The streams below them are those of a scenario's runs.
const FIRST_STREAM: usize = 100;
/// Errors of the parameters of a run, 1 sigma.
const ERRORS: &str =
    "{ mass_sigma = 0.1, drag_sigma = 0.1, rolling_sigma = 0.1, torque_sigma = 0.04 }";
/// Distance over which Valhalla takes a slope, m.
const SLOPE_M: f64 = 60.0;

/// Errors of a map on a part of the road.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapError {
    pub(super) rmse_percent: f64,
    pub(super) nees: f64,
}

/// Errors of terrain on a structure, %.
pub(super) struct TerrainError {
    pub(super) rmse: f64,
    pub(super) largest: f64,
    pub(super) clamped: f64,
    pub(super) straight: f64,
}

/// One road with its truth and its terrain.
pub(super) struct Campaign {
    seed: u64,
    road: Road,
    known: KnownRoad,
    posts: Vec<(f64, f64)>,
    terrain: GradeProfile,
}

impl Campaign {
    pub(super) fn new(seed: u64) -> Result<Self> {
        let road = scenario(seed, "[[runs]]\nname = \"x\"\ntruck = \"A\"\n")?.road;
        let posts = structures::posts(&road);
        Ok(Self {
            seed,
            known: KnownRoad::new(&road).map_err(|e: RoadProblem| problem(&e))?,
            terrain: GradeProfile::from_altitudes(posts.iter().copied(), SLOPE_M),
            posts,
            road,
        })
    }

    /// Returns the runs of a truck; calls `done` after each.
    pub(super) fn drive(
        &self,
        truck: Preset,
        runs: usize,
        done: impl Fn() + Sync,
    ) -> Result<Vec<Vec<RunRow>>> {
        let number = truck as usize;
        let mut rng = stream(self.seed, FIRST_STREAM + number, Purpose::Parameters);
        let mut text = "[rates]\nfast_ms = 100.0\n[gnss]\noutages_m = [".to_owned();
        for outage in structures::outages_m() {
            let _ = write!(text, "[{:?}, {:?}], ", outage.start, outage.end);
        }
        text.push_str("]\n");
        for run in 0..runs {
            let from_deg: f64 = rng.random_range(0.0..360.0);
            let _ = writeln!(
                text,
                "[[runs]]\nname = \"r{run}\"\ntruck = \"{}\"\nerrors = {ERRORS}\n\
                 wind = {{ speed_mps = 2.0, from_deg = {from_deg:?} }}",
                truck.name()
            );
        }
        let mut scenario = scenario(self.seed, &text)?;
        // The road exists already. All other random numbers are the truck's own.
        scenario.seed = self.seed.wrapping_mul(1_000).wrapping_add(number as u64);
        (0..runs)
            .into_par_iter()
            .map(|run| {
                let run = simulate(&scenario, run)?;
                let mut recorder =
                    Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default())
                        .map_err(|e| problem(&e))?;
                for frame in &run.frames {
                    recorder.on_frame(frame);
                }
                let rows = recorder.finish()?.rows;
                done();
                Ok(rows)
            })
            .collect()
    }

    /// Returns the map of these runs, each a session of its own.
    pub(super) fn map(&self, runs: &[&Vec<RunRow>]) -> Vec<MapRow> {
        let sessions: Vec<SessionRun> = runs
            .iter()
            .map(|rows| SessionRun {
                session: None,
                rows,
            })
            .collect();
        fuse(&self.known.network, &sessions).map.fused().rows()
    }

    /// Returns the error of a map on a part of the road.
    pub(super) fn map_error(&self, map: &[MapRow], range_m: &Range<f64>) -> MapError {
        let errors = map
            .iter()
            .filter(|row| range_m.contains(&row.distance_m))
            .map(|row| {
                let error = row.grade_percent - self.true_percent(row.distance_m);
                (error.powi(2), (error / row.grade_sigma_percent).powi(2))
            });
        let (squares, normalised): (Vec<f64>, Vec<f64>) = errors.unzip();
        MapError {
            rmse_percent: mean(&squares).sqrt(),
            nees: mean(&normalised),
        }
    }

    /// Returns the errors of terrain on a structure.
    pub(super) fn terrain_errors(&self, structure: &Structure) -> TerrainError {
        let range_m = structure.range_m();
        let ends = [range_m.start, range_m.end].map(|at_m| linear(&self.posts, at_m));
        let straight = match ends {
            [Some(from), Some(to)] => 100.0 * (to - from) / structure.length_m,
            _ => 0.0,
        };
        let errors: Vec<[f64; 3]> = cells(&range_m)
            .filter_map(|at_m| {
                let truth = self.true_percent(at_m);
                let terrain = self.terrain_percent(at_m)?;
                let clamped = terrain.clamp(-CLAMP_PERCENT, CLAMP_PERCENT);
                Some([terrain, clamped, straight].map(|grade| grade - truth))
            })
            .collect();
        let rmse = |which: usize| {
            let squares: Vec<f64> = errors.iter().map(|all| all[which].powi(2)).collect();
            mean(&squares).sqrt()
        };
        TerrainError {
            rmse: rmse(0),
            largest: errors.iter().map(|all| all[0].abs()).fold(0.0, f64::max),
            clamped: rmse(1),
            straight: rmse(2),
        }
    }

    /// Returns the true grade, %.
    pub(super) fn true_percent(&self, at_m: f64) -> f64 {
        100.0 * self.road.grade(at_m)
    }

    /// Returns the slope of terrain, %; `None` beyond its ends.
    pub(super) fn terrain_percent(&self, at_m: f64) -> Option<f64> {
        self.terrain.grade_percent(at_m)
    }

    /// Returns a grade for each cell of a part of the road, over km.
    pub(super) fn grades(
        &self,
        range_m: Range<f64>,
        grade_percent: impl Fn(f64) -> Option<f64>,
    ) -> Vec<(f64, f64)> {
        cells(&range_m)
            .filter_map(|at_m| Some((at_m * 1e-3, grade_percent(at_m)?)))
            .collect()
    }
}

fn cells(range_m: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let (first, last) = (range_m.start / GRID_M, range_m.end / GRID_M);
    (first.ceil() as usize..last.floor() as usize).map(|number| number as f64 * GRID_M)
}

fn scenario(seed: u64, rest: &str) -> Result<Scenario> {
    let text = format!("seed = {seed}\n[road]\nlength_m = {LENGTH_M:?}\n{rest}");
    Scenario::parse(&text, Path::new(ORIGIN))
}

fn problem(problem: &impl Display) -> Error {
    Error::content(Path::new(ORIGIN), problem.to_string())
}
