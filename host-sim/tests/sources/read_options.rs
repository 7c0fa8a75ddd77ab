//! Options of reading, as a user gives them.

use predicates::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::program;

/// A simulated drive in its own folder, and its log as lines.
fn drive() -> (TempDir, Vec<String>) {
    let folder = TempDir::new().expect("a temporary folder");
    let scenario = folder.path().join("scenario.toml");
    let text = "[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(&scenario, text).expect("a temporary file");
    let mut simulate = program();
    simulate.args(["simulate", "--scenario"]).arg(&scenario);
    simulate.arg("--out").arg(folder.path()).assert().success();
    let log = fs::read_to_string(folder.path().join("a.log")).expect("a log");
    (folder, log.lines().map(str::to_owned).collect())
}

fn estimate(folder: &Path, log: &Path, options: &[&str]) -> assert_cmd::assert::Assert {
    let mut estimate = program();
    estimate.args(["estimate", "--vehicle"]);
    estimate.arg(folder.join("a.vehicle.toml"));
    estimate.arg("--out").arg(folder.join("run.csv"));
    estimate.args(options).arg(log).assert()
}

/// Returns the hexadecimal number of the parameter group of a line.
fn pgn_of(line: &str) -> &str {
    let id = line.split(' ').nth(2).expect("a frame");
    &id[2..6]
}

fn write(folder: &Path, lines: impl Iterator<Item = String>) -> PathBuf {
    let path = folder.join("changed.log");
    let text: Vec<String> = lines.map(|line| line + "\n").collect();
    fs::write(&path, text.concat()).expect("a temporary file");
    path
}

#[test]
fn an_ignored_signal_is_as_if_the_bus_did_not_have_it() {
    let (folder, lines) = drive();
    let cells = || fs::read(folder.path().join("run.csv")).expect("a run");
    let log = folder.path().join("a.log");
    estimate(folder.path(), &log, &[]).success();
    let all = cells();
    let words = predicate::str::contains("no speed");
    let options = ["--ignore=wheel_speed_mps", "--ignore=front_axle_speed_mps"];
    estimate(folder.path(), &log, &options)
        .failure()
        .stderr(words);
    for (pgn, options) in [
        ("F000", &["--ignore", "retarder_torque_percent"][..]),
        (
            "FEF5",
            &["--ignore=ambient_celsius", "--ignore=air_pressure_pa"],
        ),
    ] {
        estimate(folder.path(), &log, options).success();
        let ignored = cells();
        let kept = lines.iter().filter(|line| pgn_of(line) != pgn).cloned();
        let without = write(folder.path(), kept);
        assert_ne!(
            fs::read(&without).expect("a log"),
            fs::read(&log).expect("a log")
        );
        estimate(folder.path(), &without, &[]).success();
        assert!(ignored == cells(), "{pgn}");
    }
    assert!(all.len() > 10_000);
}

#[test]
fn an_ignored_signal_is_not_in_an_inspection() {
    let (folder, _) = drive();
    let table = folder.path().join("table.csv");
    fs::write(&table, "time_s,altitude_m,wheel_speed_mps\n1,2,3\n2,2,3\n").expect("a table");
    for log in [folder.path().join("a.log"), table] {
        let inspect = |options: &[&str]| {
            let mut inspect = program();
            let output = inspect.arg("inspect").arg(&log).args(options).assert();
            let output = output.success().get_output().stdout.clone();
            String::from_utf8(output).expect("text")
        };
        let has = |text: &str| text.lines().any(|line| line.starts_with("| altitude_m"));
        assert!(has(&inspect(&[])));
        assert!(!has(&inspect(&["--ignore", "altitude_m"])));
        assert!(inspect(&["--ignore", "altitude_m"]).contains("MISSING"));
    }
}

#[test]
fn an_unknown_signal_is_a_usage_error_with_a_suggestion() {
    for (name, expected) in [("altitude", "altitude_m"), ("fan", "fan_percent")] {
        let mut inspect = program();
        inspect.args(["inspect", "--ignore", name, "a.log"]);
        let words = predicate::str::contains(format!("did you mean `{expected}`?"));
        inspect.assert().code(2).stderr(words);
    }
}
