//! A road that trucks drive all day with the same wrong parameters, and the scores of its maps.
//! Tests use it as well.

use crate::error::{Error, Result};
use crate::files::run::RunCell;
use crate::map::{
    CellSums, Dependence, FusedMap, GRID_M, GradeMap, MapRow, PlacedRun, RoadProblem, place,
};
use crate::recorder::Recorder;
use crate::score::{ScoreRow, Unscorable};
use crate::simulator::random::{Purpose, normal, stream};
use crate::simulator::scenario::Scenario;
use crate::simulator::simulate;
use crate::simulator::truck::Preset;
use crate::study::known_road::KnownRoad;
use estimator_core::Tuning;
use rand::RngExt;
use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};
use std::path::Path;

/// Length of the road, m.
const LENGTH_M: f64 = 20_000.0;
/// Name in messages, in place of the scenario's file.
const ORIGIN: &str = "fleet";
/// Distance between the seeds of two roads' days.
const DAYS_APART: u64 = 1_000;
/// First stream of the days' parameters. The streams below it are those of a scenario's runs.
const FIRST_STREAM: usize = 100;

/// Independent errors with the stated variances.
const INDEPENDENT: Dependence = Dependence {
    share: 0.0,
    inflation: 1.0,
};

/// One generated road.
#[derive(Debug)]
pub struct FleetRoad {
    seed: u64,
    road: KnownRoad,
}

impl FleetRoad {
    /// Creates the road of a seed.
    ///
    /// # Errors
    /// Returns an error if the seed is outside the range of a scenario.
    pub fn new(seed: u64) -> Result<Self> {
        let road = scenario(seed, "[[runs]]\nname = \"x\"\ntruck = \"A\"\n")?.road;
        Ok(Self {
            seed,
            road: KnownRoad::new(&road).map_err(|e: RoadProblem| problem(&e))?,
        })
    }

    /// Returns the runs of one truck on one day, placed on the road. Mass, drag and rolling
    /// resistance are wrong by 10 %, torque by 4 % (1 sigma); tyres are cold; wind is 2 m/s from
    /// any direction.
    ///
    /// # Errors
    /// Returns an error if a drive cannot be simulated or stored.
    pub fn day(&self, number: usize, truck: Preset, runs: usize) -> Result<Vec<PlacedRun>> {
        let mut rng = stream(self.seed, FIRST_STREAM + number, Purpose::Parameters);
        let mut factor = |sigma: f64| (1.0 + sigma * normal(&mut rng)).clamp(0.7, 1.3);
        let errors = format!(
            "{{ mass_factor = {}, drag_factor = {}, rolling_factor = {}, torque_factor = {} }}",
            factor(0.1),
            factor(0.1),
            factor(0.1),
            factor(0.04)
        );
        let mut text = format!(
            "[rates]\nfast_ms = 100.0\n[tyres]\ncold_amount = 0.3\n\
             [wind]\nspeed_mps = 2.0\nfrom_deg = {}\ngust_sigma_mps = 0.3\ngust_time_s = 120.0\n",
            rng.random_range(0..360)
        );
        for run in 0..runs {
            let _ = write!(
                text,
                "[[runs]]\nname = \"r{run}\"\ntruck = \"{}\"\nerrors = {errors}\n",
                truck.name()
            );
        }
        let mut scenario = scenario(self.seed, &text)?;
        // The road exists already. All other random numbers are the day's own.
        scenario.seed = self
            .seed
            .wrapping_mul(DAYS_APART)
            .wrapping_add(number as u64);
        (0..runs).map(|run| self.drive(&scenario, run)).collect()
    }

    fn drive(&self, scenario: &Scenario, run: usize) -> Result<PlacedRun> {
        let run = simulate(scenario, run)?;
        let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default())
            .map_err(|e| problem(&e))?;
        for frame in &run.frames {
            recorder.on_frame(frame);
        }
        let cells: Vec<RunCell> = recorder.finish()?.rows.iter().map(RunCell::from).collect();
        Ok(place(&self.road.network, &cells))
    }

    /// Returns the map of the runs; each day is a session.
    pub fn map(&self, days: &[&[PlacedRun]]) -> FusedMap {
        let mut map = GradeMap::new(&self.road.network);
        for (number, runs) in days.iter().enumerate() {
            for run in *runs {
                map.add_placed(Some(&number.to_string()), run);
            }
        }
        map.fused()
    }

    /// Returns the score of a map.
    ///
    /// # Errors
    /// Returns an error if the map has no cell far enough from its ends.
    pub fn score(&self, map: &[MapRow]) -> Result<ScoreRow> {
        self.road.score(map).map_err(|e: Unscorable| problem(&e))
    }
}

/// Returns the rows of a map with the sigmas of independent runs: the mean of the single runs, each
/// weighted by the inverse of its variance.
pub fn as_if_independent<'a>(
    map: &[MapRow],
    runs: impl Iterator<Item = &'a PlacedRun>,
) -> Vec<MapRow> {
    let mut sums: BTreeMap<i64, CellSums> = BTreeMap::new();
    for cell in runs.flat_map(|run| &run.cells) {
        let one = CellSums::of((cell.grade_percent, cell.grade_variance), None);
        sums.entry(cell.number).or_default().merge(&one);
    }
    let alike = |row: &MapRow| {
        let number = (row.distance_m / GRID_M).round() as i64;
        let (grade_percent, variance) = sums.get(&number)?.grade(&INDEPENDENT)?;
        Some(MapRow {
            grade_percent,
            grade_sigma_percent: variance.sqrt(),
            ..*row
        })
    };
    map.iter().filter_map(alike).collect()
}

fn scenario(seed: u64, rest: &str) -> Result<Scenario> {
    let text = format!("seed = {seed}\n[road]\nlength_m = {LENGTH_M:?}\n{rest}");
    Scenario::parse(&text, Path::new(ORIGIN))
}

fn problem(problem: &impl Display) -> Error {
    Error::content(Path::new(ORIGIN), problem.to_string())
}
