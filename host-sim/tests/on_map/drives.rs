//! What tests of the program on simulated drives share: truth, tables, and runs with and without a map.

use host_sim::files::run::RunRow;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;
use test_kit::command::roadgrade;

/// Truth of a simulated drive, and of the road under it.
#[derive(Deserialize)]
pub struct Truth {
    pub distance_m: f64,
    pub grade_percent: f64,
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

/// Runs the program with `--json`, and returns what it prints.
pub fn json(folder: &Path, arguments: &[&str]) -> Value {
    let done = roadgrade(folder, &[arguments, &["--json"]].concat()).success();
    serde_json::from_slice(&done.get_output().stdout).expect("JSON")
}
