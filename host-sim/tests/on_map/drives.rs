//! What tests of the program on simulated drives share: truth, tables, and runs with and without a map.

use host_sim::files::run::{RunRow, read};
use serde::Deserialize;
use serde_json::Value;
use std::fmt;
use std::ops::{AddAssign, Range};
use std::path::{Path, PathBuf};
use test_kit::command::roadgrade;

/// Truth of a simulated drive, and of the road under it.
#[derive(Deserialize)]
pub struct Truth {
    pub distance_m: f64,
    pub grade_percent: f64,
}

/// A row of the road ahead.
#[derive(Deserialize)]
pub struct Ahead {
    pub distance_m: f64,
    pub branch: u32,
    pub probability: f64,
    pub ahead_m: f64,
    pub grade_percent: Option<f64>,
    pub grade_sigma_percent: Option<f64>,
}

/// Reads a table.
pub fn rows<T: for<'a> Deserialize<'a>>(path: &Path) -> Vec<T> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let rows = reader.deserialize();
    rows.map(|row| row.expect("a row")).collect()
}

pub fn truth_at(truth: &[Truth], distance_m: f64) -> Option<f64> {
    let next = truth.partition_point(|row| row.distance_m < distance_m);
    truth.get(next).map(|row| row.grade_percent)
}

/// Sums of errors of grades.
#[derive(Clone, Copy, Default)]
pub struct Errors {
    squares: f64,
    normalised: f64,
    count: f64,
}

impl Errors {
    /// Adds an error and its standard deviation.
    pub fn add(&mut self, error: f64, sigma: f64) {
        self.squares += error * error;
        self.normalised += (error / sigma).powi(2);
        self.count += 1.0;
    }

    /// Adds the live grades of a drive without its first and last 500 m.
    pub fn add_drive(&mut self, folder: &Path, name: &str, run: &[RunRow]) {
        let end_m = run.last().expect("cells").distance_m - 500.0;
        self.add_live(folder, name, run, 500.0..end_m);
    }

    /// Adds the live grades of a part of a drive.
    pub fn add_live(&mut self, folder: &Path, name: &str, run: &[RunRow], part_m: Range<f64>) {
        let truth: Vec<Truth> = rows(&folder.join(format!("{name}.truth.csv")));
        for row in run.iter().filter(|row| part_m.contains(&row.distance_m)) {
            if let Some(truth_percent) = truth_at(&truth, row.distance_m) {
                let error = row.live_grade_percent - truth_percent;
                self.add(error, row.live_grade_sigma_percent);
            }
        }
    }

    pub fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    pub fn normalised(&self) -> f64 {
        self.normalised / self.count
    }
}

impl AddAssign for Errors {
    fn add_assign(&mut self, other: Self) {
        self.squares += other.squares;
        self.normalised += other.normalised;
        self.count += other.count;
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4} % ({:.2})", self.rms(), self.normalised())
    }
}

/// Returns the profile of the thesis's road; `None`, and says so, if it is absent.
pub fn measured_road() -> Option<PathBuf> {
    let road = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/e4/road.csv");
    if road.exists() {
        return Some(road);
    }
    eprintln!("SKIPPED: no measured profile at ../shared/data/e4");
    None
}

/// Asserts that a map changes only live grades, where it is known and to a smaller sigma. Returns the
/// number of rows where it is known.
pub fn assert_only_live_changes(with: &[RunRow], without: &[RunRow]) -> usize {
    assert_eq!(with.len(), without.len());
    let mut on_map = 0;
    for (with, without) in with.iter().zip(without) {
        assert_eq!(without.map_grade_percent, None);
        assert_eq!(with.smoothed(), without.smoothed());
        assert_eq!(with.lagged(), without.lagged());
        match with.map_grade_percent {
            None => assert_eq!(with.live(), without.live()),
            Some(_) => {
                on_map += 1;
                assert!(with.live().1 < without.live().1);
            }
        }
    }
    on_map
}

/// Estimates a simulated drive.
pub fn estimate(folder: &Path, name: &str, options: &[&str]) -> Vec<RunRow> {
    let (vehicle, out, log) = (
        format!("{name}.vehicle.toml"),
        format!("{name}.csv"),
        format!("{name}.log"),
    );
    let arguments = ["estimate", "--vehicle", &vehicle, "--out", &out, &log];
    roadgrade(folder, &[&arguments[..], options].concat()).success();
    read(&folder.join(out)).expect("a run")
}

/// Runs the program with `--json`, and returns what it prints.
pub fn json(folder: &Path, arguments: &[&str]) -> Value {
    let done = roadgrade(folder, &[arguments, &["--json"]].concat()).success();
    serde_json::from_slice(&done.get_output().stdout).expect("JSON")
}
