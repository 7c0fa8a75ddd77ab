//! Drives of two trucks over one road, whose receivers are late by different times that nobody
//! knows. Tests use them as well.

use crate::error::{Error, Result};
use crate::files::run::{RunCell, RunRow};
use crate::map::{GRID_M, MapRow, RoadProblem, SessionRun, road_distances};
use crate::numeric::series::linear;
use crate::numeric::statistics::mean;
use crate::recorder::Recorder;
use crate::score::{END_CUT_M, ScoreRow, Unscorable, score_map};
use crate::simulator::Recording;
use crate::simulator::random::{Purpose, stream};
use crate::simulator::scenario::Scenario;
use crate::simulator::truck::Preset;
use crate::study::known_road::KnownRoad;
use estimator_core::Tuning;
use rand::RngExt;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};
use std::path::{Path, PathBuf};

/// Name in messages, in place of the scenario's file.
const ORIGIN: &str = "alignment";
/// First stream of the vehicles' parameters. The streams below it are those of a scenario's runs.
const FIRST_STREAM: usize = 100;
/// Errors of the parameters of a run, 1 sigma.
const ERRORS: &str =
    "{ mass_sigma = 0.1, drag_sigma = 0.1, rolling_sigma = 0.1, torque_sigma = 0.04 }";
/// Age of a wheel speed when it arrives, s: that of a scenario without another one.
const WHEELS_LATE_S: f64 = 0.03;

/// The road of a campaign and the part of it that is driven.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// File of the road; a generated one without it.
    pub road: Option<PathBuf>,
    /// Start and length of the part, m.
    pub from_m: f64,
    /// See [`from_m`](Self::from_m).
    pub length_m: f64,
}

/// A truck, its number of runs, and the age of its fixes; `None` draws 0 to 400 ms.
#[derive(Clone, Copy, Debug)]
pub struct Vehicle {
    /// Its type.
    pub truck: Preset,
    /// Number of its runs.
    pub runs: usize,
    /// Age of a fix when it arrives, ms.
    pub gnss_late_ms: Option<f64>,
}

/// Runs of one truck in the same conditions.
#[derive(Clone, Debug)]
pub struct RunGroup {
    /// Its type.
    pub truck: Preset,
    /// Sections of the scenario.
    pub sections: String,
    /// Keys of each run beside its truck and its part of the road.
    pub runs: Vec<String>,
}

/// One finished run.
#[derive(Clone, Debug)]
pub struct CampaignRun {
    /// Its rows.
    pub rows: Vec<RunRow>,
    /// True time, s, and distance along the road, m.
    truth: Vec<(f64, f64)>,
    /// Age of its fixes, ms.
    pub gnss_late_ms: f64,
}

/// The road with its truth.
#[derive(Debug)]
pub struct Campaign {
    seed: u64,
    stretch: Stretch,
    road: KnownRoad,
}

impl Campaign {
    /// Creates a campaign on a part of a road.
    ///
    /// # Errors
    /// Returns an error if the road cannot be read.
    pub fn new(seed: u64, stretch: Stretch) -> Result<Self> {
        let road = scenario(seed, &stretch, "[[runs]]\nname = \"x\"\ntruck = \"A\"\n")?.road;
        Ok(Self {
            seed,
            road: KnownRoad::new(&road).map_err(|e: RoadProblem| problem(&e))?,
            stretch,
        })
    }

    /// Drives all runs of these vehicles, estimated with this tuning; calls `done` after each. Mass, drag and rolling
    /// resistance of a run are wrong by 10 %, torque by 4 % (1 sigma); every second run has a
    /// wind of 3 m/s from any direction.
    ///
    /// # Errors
    /// Returns an error if a drive cannot be simulated or stored.
    pub fn drive(
        &self,
        vehicles: &[Vehicle],
        tuning: &Tuning,
        done: impl Fn() + Sync,
    ) -> Result<Vec<CampaignRun>> {
        let groups: Vec<RunGroup> = vehicles
            .iter()
            .enumerate()
            .map(|(number, vehicle)| self.of_vehicle(number, vehicle))
            .collect();
        self.drive_groups(&groups, tuning, done)
    }

    /// Drives all runs of these groups, estimated with this tuning, in their order; calls `done`
    /// after each. The random numbers of a group depend on its place among them.
    ///
    /// # Errors
    /// Returns an error if a group is no scenario, or if a drive cannot be simulated or stored.
    pub fn drive_groups(
        &self,
        groups: &[RunGroup],
        tuning: &Tuning,
        done: impl Fn() + Sync,
    ) -> Result<Vec<CampaignRun>> {
        let scenarios: Vec<Scenario> = groups
            .iter()
            .enumerate()
            .map(|(number, group)| self.scenario(number, group))
            .collect::<Result<_>>()?;
        let all = scenarios.iter().flat_map(|scenario| {
            let runs = 0..scenario.runs.len();
            runs.map(move |run| (scenario, run))
        });
        let all: Vec<(&Scenario, usize)> = all.collect();
        all.into_par_iter()
            .map(|(scenario, run)| {
                let run = self.run(scenario, run, tuning);
                done();
                run
            })
            .collect()
    }

    fn of_vehicle(&self, number: usize, vehicle: &Vehicle) -> RunGroup {
        let mut rng = stream(self.seed, FIRST_STREAM + number, Purpose::Parameters);
        let drawn_ms = rng.random_range(0.0..400.0);
        let late_ms = vehicle.gnss_late_ms.unwrap_or(drawn_ms);
        let runs = (0..vehicle.runs).map(|run| {
            let from_deg: f64 = rng.random_range(0.0..360.0);
            let wind = if run % 2 == 1 {
                format!("wind = {{ speed_mps = 3.0, from_deg = {from_deg:?} }}\n")
            } else {
                String::new()
            };
            format!("errors = {ERRORS}\n{wind}")
        });
        RunGroup {
            truck: vehicle.truck,
            runs: runs.collect(),
            sections: format!("[rates]\nfast_ms = 100.0\n[latency_ms]\ngnss = {late_ms:?}\n"),
        }
    }

    fn scenario(&self, number: usize, group: &RunGroup) -> Result<Scenario> {
        let mut text = group.sections.clone();
        for (run, keys) in group.runs.iter().enumerate() {
            let _ = write!(
                text,
                "[[runs]]\nname = \"r{run}\"\ntruck = \"{}\"\nstart_distance_m = {:?}\n\
                 length_m = {:?}\n{keys}",
                group.truck.name(),
                self.stretch.from_m,
                self.stretch.length_m,
            );
        }
        let mut scenario = scenario(self.seed, &self.stretch, &text)?;
        // The road exists already. All other random numbers are the group's own.
        scenario.seed = self.seed.wrapping_mul(1_000).wrapping_add(number as u64);
        Ok(scenario)
    }

    fn run(&self, scenario: &Scenario, index: usize, tuning: &Tuning) -> Result<CampaignRun> {
        let recording = Recording::new(scenario, index)?;
        let vehicle = &scenario.runs[index].vehicle;
        let mut recorder =
            Recorder::<f32>::new(vehicle.model.clone(), tuning.clone()).map_err(|e| problem(&e))?;
        let mut first_s = None;
        for frame in recording.frames() {
            first_s.get_or_insert(frame.time.micros() as f64 * 1e-6);
            recorder.on_frame(&frame);
        }
        let start = recording.drive().at(first_s.unwrap_or_default());
        let start_m = start.distance_m;
        let truth = recording.truth().into_iter();
        let truth = truth.map(|row| (row.time_s, start_m + row.distance_m));
        Ok(CampaignRun {
            rows: recorder.finish()?.rows,
            truth: truth.collect(),
            gnss_late_ms: scenario.latency_ms.gnss,
        })
    }

    /// Returns the map of these runs, each a session of its own.
    #[must_use]
    pub fn map(&self, runs: &[&CampaignRun]) -> Vec<MapRow> {
        let alone: Vec<_> = runs.iter().map(|&run| (None, run)).collect();
        self.map_of_sessions(&alone)
    }

    /// Returns the map of these runs, each with its session.
    #[must_use]
    pub fn map_of_sessions(&self, runs: &[(Option<&str>, &CampaignRun)]) -> Vec<MapRow> {
        let sessions: Vec<SessionRun> = runs
            .iter()
            .map(|(session, run)| SessionRun {
                session: *session,
                rows: &run.rows,
            })
            .collect();
        crate::map::fuse(&self.road.network, &sessions)
            .map
            .fused()
            .rows()
    }

    /// Returns the score of a map.
    ///
    /// # Errors
    /// Returns an error if the map has no cell far enough from its ends.
    pub fn score(&self, map: &[MapRow]) -> Result<ScoreRow> {
        self.road.score(map).map_err(|e: Unscorable| problem(&e))
    }

    /// Returns the errors of a map by the number of its cell, %, those at its ends left out.
    #[must_use]
    pub fn errors_percent(&self, map: &[MapRow]) -> BTreeMap<i64, f64> {
        let (Some(first), Some(last)) = (map.first(), map.last()) else {
            return BTreeMap::new();
        };
        let inside = first.distance_m + END_CUT_M..=last.distance_m - END_CUT_M;
        map.iter()
            .filter(|row| inside.contains(&row.distance_m))
            .filter_map(|row| {
                let number = (row.distance_m / GRID_M).round() as i64;
                let true_percent = linear(&self.road.truth, row.distance_m)?;
                Some((number, row.grade_percent - true_percent))
            })
            .collect()
    }

    /// Returns the score of a map that is moved along the road as a whole, by the distance at which
    /// its error is least, and that distance, m: what placing all runs better by hand would reach.
    ///
    /// # Errors
    /// Returns an error if the map has no cell far enough from its ends.
    pub fn score_moved(&self, map: &[MapRow]) -> Result<(ScoreRow, f64)> {
        let mut best: Option<(ScoreRow, f64)> = None;
        for step in -80..=80_i32 {
            let moved_m = 0.1 * f64::from(step);
            let moved: Vec<(f64, f64)> = self
                .road
                .truth
                .iter()
                .map(|(at_m, grade)| (at_m + moved_m, *grade))
                .collect();
            let score = score_map(map, &moved).map_err(|e: Unscorable| problem(&e))?;
            if best
                .as_ref()
                .is_none_or(|(known, _)| score.rmse_percent < known.rmse_percent)
            {
                best = Some((score, moved_m));
            }
        }
        best.ok_or_else(|| problem(&"no score"))
    }

    /// Returns the true distance of each cell of a run along the road, m: where the odometer was. A
    /// wheel speed arrives late as well.
    fn true_m<'a>(&self, run: &'a CampaignRun) -> impl Iterator<Item = Option<f64>> + use<'a> {
        let of = |row: &RunRow| linear(&run.truth, row.time_s - WHEELS_LATE_S);
        run.rows.iter().map(of)
    }

    /// Returns the run with true positions.
    #[must_use]
    pub fn truly_placed(&self, run: &CampaignRun) -> CampaignRun {
        let line = &self.road.network.ways()[0].line;
        let rows = run.rows.iter().zip(self.true_m(run)).map(|(row, true_m)| {
            let position = true_m.map(|true_m| line.position_at(true_m));
            RunRow {
                latitude_deg: position.map(|place| place.0),
                longitude_deg: position.map(|place| place.1),
                ..*row
            }
        });
        CampaignRun {
            rows: rows.collect(),
            ..run.clone()
        }
    }

    /// Returns by how much the cells of a run are placed too far along the road, m: mean, and mean
    /// without sign.
    #[must_use]
    pub fn misplaced_m(&self, run: &CampaignRun) -> (f64, f64) {
        let cells: Vec<RunCell> = run.rows.iter().map(RunCell::from).collect();
        let placed = road_distances(&self.road.network, &cells);
        let (from_m, to_m) = (
            self.stretch.from_m + END_CUT_M,
            self.stretch.from_m + self.stretch.length_m - END_CUT_M,
        );
        let errors: Vec<f64> = self
            .true_m(run)
            .zip(placed)
            .filter_map(|(true_m, placed_m)| {
                let (true_m, placed_m) = (true_m?, placed_m?);
                (from_m..to_m)
                    .contains(&true_m)
                    .then_some(placed_m - true_m)
            })
            .collect();
        let sizes: Vec<f64> = errors.iter().map(|m| m.abs()).collect();
        (mean(&errors), mean(&sizes))
    }
}

fn scenario(seed: u64, stretch: &Stretch, rest: &str) -> Result<Scenario> {
    let road = match &stretch.road {
        Some(path) => format!("file = {:?}", path.display().to_string()),
        None => format!("length_m = {:?}", stretch.from_m + stretch.length_m),
    };
    let text = format!("seed = {seed}\n[road]\n{road}\n{rest}");
    Scenario::parse(&text, Path::new(ORIGIN))
}

fn problem(problem: &impl Display) -> Error {
    Error::content(Path::new(ORIGIN), problem.to_string())
}
