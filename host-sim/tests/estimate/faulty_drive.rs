//! Simulated drives on which something is wrong, and whether their sigmas are true.

use estimator_core::{Counters, Delays, Instant, Reading, Signal, Tuning, Value};
use host_sim::files::run::RunRow;
use host_sim::numeric::series::linear;
use host_sim::recorder::Recorder;
use host_sim::simulator::SimulatedRun;
use test_kit::simulated::{readings, run};

/// A reading and its time, s.
pub type Timed = (f64, Signal, Value);

/// Simulates a drive of this length, km: parameters within one sigma, wind, a usual receiver.
/// `more` goes into `[[runs]]`.
pub fn simulated(truck: &str, seed: u32, km: u32, road: &str, more: &str) -> SimulatedRun {
    run(&[&format!(
        "seed = {seed}\n[road]\nlength_m = {km}000.0\n{road}\n[rates]\nfast_ms = 100.0\n\
         [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n{more}"
    )])
}

/// Returns what the bus reports. Like most buses, it does not report the mass.
pub fn reported(run: &SimulatedRun) -> Vec<Timed> {
    let start = run.frames[0].time;
    readings(run)
        .into_iter()
        // The speed of one axle only, as with the source lock on a bus.
        .filter(|reading| ![Signal::FrontAxleSpeed, Signal::Mass].contains(&reading.2))
        .map(|(time, _, signal, value)| (1e-6 * time.since(start).micros() as f64, signal, value))
        .collect()
}

/// Returns the same readings, with other values of a signal.
pub fn edited(
    reported: &[Timed],
    edited: Signal,
    mut value: impl FnMut(f64, f32) -> Option<f32>,
) -> Vec<Timed> {
    reported
        .iter()
        .filter_map(|&(seconds, signal, reading)| match reading {
            Value::Real(number) if signal == edited => {
                Some((seconds, signal, Value::Real(value(seconds, number)?)))
            }
            _ => Some((seconds, signal, reading)),
        })
        .collect()
}

/// The torque without its fraction of a percent, which would have to change with it.
pub fn with_torque(reported: &[Timed], value: impl FnMut(f64, f32) -> Option<f32>) -> Vec<Timed> {
    let whole: Vec<Timed> = reported
        .iter()
        .filter(|reading| reading.1 != Signal::EngineTorqueFraction)
        .copied()
        .collect();
    edited(&whole, Signal::EngineTorque, value)
}

/// A judged drive.
pub struct Judged {
    pub rows: Vec<RunRow>,
    pub counters: Counters,
    pub delays: Delays,
    /// Of smoothed, lagged and live grades.
    pub of: [Judgement; 3],
}

/// How true the sigmas of one kind of estimate are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Judgement {
    /// Over all cells.
    pub rmse_percent: f64,
    /// Mean normalised squared error of unmarked cells, and the largest one over 5 km.
    pub nees: f64,
    pub worst: f64,
    /// Part of the cells that are marked.
    pub marked: f64,
}

/// Estimates what is reported on a drive, and compares it with the truth at the same times. Leaves
/// out 500 m at both ends, and the live grade in the first 500 m after `onset_m`.
pub fn judged(run: &SimulatedRun, reported: &[Timed], onset_m: f64) -> Judged {
    let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default()).unwrap();
    for &(seconds, signal, value) in reported {
        let time = Instant::from_micros((1e6 * (1.0 + seconds)).round() as u64);
        recorder.on_reading(time, Reading { signal, value });
    }
    let found = recorder.finish().unwrap();
    let truth: Vec<(f64, f64)> = run
        .truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    let end_m = found.rows.last().unwrap().distance_m - 500.0;
    let rows: Vec<RunRow> = found.rows;
    let of = [0, 1, 2].map(|kind| {
        let cells = rows
            .iter()
            .filter(|row| (500.0..end_m).contains(&row.distance_m))
            .filter(|row| kind < 2 || !(onset_m..onset_m + 500.0).contains(&row.distance_m))
            .filter_map(|row| {
                let (value, sigma, consistent) = match kind {
                    0 => (row.grade_percent, row.grade_sigma_percent, row.consistent),
                    1 => (
                        row.lagged_grade_percent,
                        row.lagged_grade_sigma_percent,
                        row.lagged_consistent,
                    ),
                    _ => (
                        row.live_grade_percent,
                        row.live_grade_sigma_percent,
                        row.live_consistent,
                    ),
                };
                let error = value - linear(&truth, row.time_s)?;
                Some((row.distance_m, error, sigma, consistent == 0))
            })
            .collect::<Vec<_>>();
        judgement(&cells)
    });
    Judged {
        rows,
        counters: found.counters,
        delays: found.delays,
        of,
    }
}

/// Returns the judgement of cells: place, error, sigma, and whether each is marked.
fn judgement(cells: &[(f64, f64, f64, bool)]) -> Judgement {
    let count = cells.len() as f64;
    assert!(count > 1_000.0, "{count} cells");
    let normalised = |cells: &[(f64, f64, f64, bool)]| {
        let unmarked: Vec<f64> = cells
            .iter()
            .filter(|cell| !cell.3)
            .map(|cell| (cell.1 / cell.2).powi(2))
            .collect();
        let sum: f64 = unmarked.iter().sum();
        (sum / unmarked.len().max(1) as f64, unmarked.len())
    };
    let window = |cell: &(f64, f64, f64, bool)| (cell.0 / 5_000.0) as u32;
    let worst = cells
        .chunk_by(|a, b| window(a) == window(b))
        .map(normalised)
        .filter(|(_, count)| *count >= 200)
        .fold(0.0_f64, |worst, (nees, _)| worst.max(nees));
    Judgement {
        rmse_percent: (cells.iter().map(|cell| cell.1 * cell.1).sum::<f64>() / count).sqrt(),
        nees: normalised(cells).0,
        worst,
        marked: cells.iter().filter(|cell| cell.3).count() as f64 / count,
    }
}

impl Judgement {
    fn keeps_the_rule(&self, what: &str) {
        assert!(self.nees < 4.0 && self.worst < 9.0, "{what}: {self:?}");
        assert!(self.marked < 0.5, "{what}: {self:?}");
    }
}

impl Judged {
    /// Checks the rule: the error is within what the sigma says, or the cell is marked. Not
    /// everything may be marked.
    pub fn keeps_the_rule(&self, what: &str) {
        for of in &self.of {
            of.keeps_the_rule(what);
        }
    }

    /// Checks the rule for the smoothed grade.
    pub fn smoothed_keeps_the_rule(&self, what: &str) {
        self.of[0].keeps_the_rule(what);
    }

    /// Checks that the smoothed error is hardly larger than that of the drive without the fault.
    pub fn is_hardly_worse_than(&self, without: &Self, what: &str) {
        let [with, without] = [self, without].map(|judged| judged.of[0].rmse_percent);
        assert!(
            with < 1.5 * without + 0.02,
            "{what}: {with} %, {without} % without"
        );
    }
}
