//! A simulated drive as a signal table, of which single columns are changed.

use estimator_core::{Instant, Signal, Value};
use host_sim::simulator::SimulatedRun;
use host_sim::source::signal_table;
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use tempfile::TempDir;
use test_kit::command::{folder, program};
use test_kit::simulated::{readings, run};

/// 12 km of truck A with a usual receiver: hills, shifts, brakes, a stop. The bus does not report
/// the mass.
pub const DRIVE: &str = "seed = 5\n[road]\nlength_m = 12000.0\n[rates]\nfast_ms = 100.0\n\
    [errors]\nmass_sigma = 0.03\ndrag_sigma = 0.05\nrolling_sigma = 0.05\ntorque_sigma = 0.02\n\
    [[runs]]\nname = \"x\"\ntruck = \"A\"\n[[runs.stops]]\nat_m = 6000.0\nseconds = 20.0\n";

/// Readings at one time.
pub type Row = BTreeMap<Signal, f64>;
/// Rows with their times, s.
pub type Table = Vec<(f64, Row)>;

/// Returns the readings of a drive as a table.
pub fn table_of(run: &SimulatedRun) -> Table {
    let mut rows: BTreeMap<Instant, Row> = BTreeMap::new();
    for (time, _, signal, value) in readings(run) {
        let value = match value {
            Value::Real(value) => f64::from(value),
            Value::DegreesE7(e7) => f64::from(e7) * 1e-7,
            Value::NotAvailable | Value::Error => continue,
        };
        if ![Signal::Mass, Signal::FrontAxleSpeed].contains(&signal) {
            rows.entry(time).or_default().insert(signal, value);
        }
    }
    let seconds = |time: Instant| time.micros() as f64 * 1e-6;
    let start_s = rows.keys().next().map_or(0.0, |time| seconds(*time));
    rows.into_iter()
        .map(|(time, row)| (seconds(time) - start_s, row))
        .collect()
}

/// Returns [`DRIVE`] as a table.
pub fn table() -> Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| table_of(&run(&[DRIVE]))).clone()
}

/// Returns [`DRIVE`] with a signal changed.
pub fn with(changed: Signal, mut change: impl FnMut(f64) -> f64) -> Table {
    let mut table = table();
    for (_, row) in &mut table {
        if let Some(value) = row.get_mut(&changed) {
            *value = change(*value);
        }
    }
    table
}

/// Returns [`DRIVE`] with its times changed.
pub fn at_times(change: impl Fn(f64) -> f64) -> Table {
    let table = table().into_iter();
    table.map(|(seconds, row)| (change(seconds), row)).collect()
}

/// Writes a table.
fn write(path: &Path, table: &Table) {
    let used: Vec<Signal> = Signal::ALL
        .iter()
        .copied()
        .filter(|signal| table.iter().any(|(_, row)| row.contains_key(signal)))
        .collect();
    let rows = table.iter().map(|(seconds, row)| {
        let time = Instant::from_micros((seconds * 1e6).round() as u64);
        let values = used.iter().map(|signal| row.get(signal).copied());
        (time, values.collect::<Vec<_>>())
    });
    signal_table::write(path, &used, rows).unwrap();
}

/// Writes the vehicle files of a scenario into a folder.
pub fn simulate(folder: &Path, scenario: &str) {
    let file = folder.join("scenario.toml");
    fs::write(&file, scenario).unwrap();
    program()
        .args(["simulate", "--scenario"])
        .arg(&file)
        .arg("--out")
        .arg(folder)
        .assert()
        .success();
}

/// Returns the text of the vehicle file of [`DRIVE`].
pub fn vehicle() -> String {
    static VEHICLE: OnceLock<String> = OnceLock::new();
    VEHICLE
        .get_or_init(|| {
            let folder = folder();
            simulate(folder.path(), DRIVE);
            fs::read_to_string(folder.path().join("x.vehicle.toml")).unwrap()
        })
        .clone()
}

/// What an estimate printed.
#[derive(Debug)]
pub struct Printed {
    pub code: i32,
    pub stderr: String,
    pub verdict: String,
    /// Codes of the warnings.
    pub codes: Vec<String>,
    pub json: Json,
}

/// Runs `roadgrade estimate --json` on a log.
pub fn estimate_log(vehicle: &Path, log: &Path) -> Printed {
    let folder = TempDir::new().unwrap();
    let output = program()
        .args(["estimate", "--json", "--vehicle"])
        .arg(vehicle)
        .arg("--out")
        .arg(folder.path().join("run.csv"))
        .arg(log)
        .output()
        .unwrap();
    let json: Json = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let warnings = json["warnings"].as_array().cloned().unwrap_or_default();
    for warning in &warnings {
        for key in ["code", "message", "advice"] {
            assert!(!warning[key].as_str().unwrap().is_empty(), "{warning}");
        }
    }
    Printed {
        code: output.status.code().unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
        verdict: json["verdict"].as_str().unwrap_or_default().to_owned(),
        codes: warnings
            .iter()
            .map(|warning| warning["code"].as_str().unwrap().to_owned())
            .collect(),
        json,
    }
}

/// Runs `roadgrade estimate --json` on a table with this vehicle file.
pub fn estimate_with(vehicle: &str, table: &Table) -> Printed {
    let folder = folder();
    let (file, log) = (folder.path().join("v.toml"), folder.path().join("x.csv"));
    fs::write(&file, vehicle).unwrap();
    write(&log, table);
    estimate_log(&file, &log)
}

/// Runs `roadgrade estimate --json` on a table with the vehicle file of the drive.
pub fn estimate(table: &Table) -> Printed {
    estimate_with(&vehicle(), table)
}

impl Printed {
    /// Checks that these and no other warnings were printed, and that the verdict has these words
    /// (none: no warning has a part in the verdict).
    pub fn warns(&self, codes: &[&str], verdict: &str, words: &str) {
        assert_eq!(self.codes, codes, "{self:?}");
        assert_eq!(self.code, 0, "{self:?}");
        self.tells(words);
        if verdict.is_empty() {
            assert!(!self.verdict.contains("not in"), "{self:?}");
        } else {
            let expected = format!("suspect: {verdict}");
            assert!(self.verdict.starts_with(&expected), "{self:?}");
        }
    }

    /// Checks that a warning with these words was printed.
    pub fn tells(&self, words: &str) {
        let is_told = |line: &str| line.starts_with("warning: ") && line.contains(words);
        assert!(self.stderr.lines().any(is_told), "{words}: {self:?}");
    }
}
