//! Simulated trucks whose parameters are wrong in the same way all day: what their maps are worth,
//! and what they say of themselves.

use estimator_core::Tuning;
use host_sim::map::{FusedMap, Network, RoadLine, RoadRow, SessionRun, fuse, read_road};
use host_sim::recorder::Recorder;
use host_sim::run_file::RunRow;
use host_sim::score::{ScoreRow, score_map};
use host_sim::world::random::{Purpose, normal, stream};
use host_sim::world::road_file;
use host_sim::world::scenario::Scenario;
use host_sim::world::simulate;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// One road, generated, with the files that scenarios need.
struct Country {
    _folder: TempDir,
    road_file: PathBuf,
    road: Network,
    /// Distance, m, and true grade, %.
    truth: Vec<(f64, f64)>,
    seed: u64,
}

impl Country {
    fn new(seed: u64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let road_file = folder.path().join("road.csv");
        let text = format!(
            "seed = {seed}\n[road]\nlength_m = 20000.0\n[[runs]]\nname = \"x\"\ntruck = \"A\"\n"
        );
        let scenario = Scenario::parse(&text, Path::new("road")).expect("a road");
        road_file::write(&road_file, &scenario.road).expect("written");
        let rows = read_road(&road_file).expect("read");
        let points = rows.iter().map(RoadRow::point).collect();
        let grade = |row: &RoadRow| (row.distance_m, row.grade_percent.expect("known"));
        Self {
            _folder: folder,
            road_file,
            road: RoadLine::new(points).expect("a road").into(),
            truth: rows.iter().map(grade).collect(),
            seed,
        }
    }

    /// Runs of one truck on one day: mass, drag and rolling resistance wrong by 10 %, torque by
    /// 4 % (1 sigma), cold tyres, wind.
    fn session(&self, number: usize, truck: &str, runs: usize) -> Vec<Vec<RunRow>> {
        let mut rng = stream(self.seed, 100 + number, Purpose::Parameters);
        let mut factor = |sigma: f64| (1.0 + sigma * normal(&mut rng)).clamp(0.7, 1.3);
        let errors = format!(
            "{{ mass_factor = {}, drag_factor = {}, rolling_factor = {}, torque_factor = {} }}",
            factor(0.1),
            factor(0.1),
            factor(0.1),
            factor(0.04)
        );
        let mut text = format!(
            "seed = {}\n[road]\nfile = {:?}\n[rates]\nfast_ms = 100.0\n[tyres]\ncold_amount = 0.3\n\
             [wind]\nspeed_mps = 2.0\nfrom_deg = {}\ngust_sigma_mps = 0.3\ngust_time_s = 120.0\n",
            self.seed * 1000 + number as u64,
            self.road_file,
            (self.seed * 77 + number as u64 * 131) % 360,
        );
        for run in 0..runs {
            let _ = write!(
                text,
                "[[runs]]\nname = \"r{run}\"\ntruck = \"{truck}\"\nerrors = {errors}\n"
            );
        }
        let scenario = Scenario::parse(&text, &self.road_file).expect("a scenario");
        (0..runs)
            .map(|run| {
                let run = simulate(&scenario, run).expect("driven");
                let vehicle = run.vehicle.parameters.clone();
                let mut recorder =
                    Recorder::<f32>::new(vehicle, Tuning::default()).expect("a vehicle");
                for frame in &run.frames {
                    recorder.on_frame(frame);
                }
                recorder.finish().unwrap().rows
            })
            .collect()
    }

    fn map(&self, sessions: &[(&str, &[Vec<RunRow>])]) -> (FusedMap, ScoreRow) {
        let runs: Vec<SessionRun> = sessions
            .iter()
            .flat_map(|(name, runs)| {
                runs.iter().map(|rows| SessionRun {
                    session: Some(name),
                    rows,
                })
            })
            .collect();
        let map = fuse(&self.road, &runs).map.fused();
        let score = score_map(&map.rows(), &self.truth).expect("scored");
        (map, score)
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    assert!(!values.is_empty());
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn sigmas_stay_honest_as_runs_of_a_day_are_added() {
    let counts = [1, 3, 5, 12];
    let nees: Vec<Vec<f64>> = (0..8_u64)
        .into_par_iter()
        .map(|seed| {
            let country = Country::new(300 + seed);
            let day = country.session(0, "A", 12);
            let score = |count: &usize| country.map(&[("day", &day[..*count])]).1.nees;
            counts.iter().map(score).collect()
        })
        .collect();
    for (i, count) in counts.iter().enumerate() {
        let nees = mean(nees.iter().map(|of_seed| of_seed[i]));
        assert!((0.5..1.5).contains(&nees), "{count} runs: {nees}");
    }
}

#[test]
fn a_light_truck_does_not_make_a_map_worse() {
    let maps: Vec<_> = (0..16_u64)
        .into_par_iter()
        .map(|seed| {
            let country = Country::new(500 + seed);
            let heavy = country.session(0, "A", 3);
            let light = country.session(1, "B", 2);
            let without = country.map(&[("heavy", &heavy)]);
            let with = country.map(&[("heavy", &heavy), ("light", &light)]);
            (without, with)
        })
        .collect();
    // In a single case chance decides, as it does when a heavy truck is added.
    let squared = |score: &ScoreRow| score.rmse_percent.powi(2);
    let without = mean(maps.iter().map(|(without, _)| squared(&without.1))).sqrt();
    let with = mean(maps.iter().map(|(_, with)| squared(&with.1))).sqrt();
    assert!(with < without, "{with} with, {without} without");
    let ratio = mean(
        maps.iter()
            .map(|(without, with)| with.1.rmse_percent / without.1.rmse_percent),
    );
    assert!(ratio < 1.0, "{ratio}");
    let nees = mean(maps.iter().map(|(_, with)| with.1.nees));
    assert!((0.5..1.5).contains(&nees), "{nees}");
    // The map is surer with more runs, unless the trucks disagree.
    let sigma = |map: &FusedMap| mean(map.rows().iter().map(|row| row.grade_sigma_percent));
    let surer = maps
        .iter()
        .filter(|(a, b)| sigma(&b.0) < sigma(&a.0))
        .count();
    assert!(surer >= 13, "{surer} of 16");
}
