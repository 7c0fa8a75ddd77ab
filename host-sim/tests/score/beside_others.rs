//! `roadgrade score` compares a run with the thesis's methods and an oracle.

use assert_cmd::assert::Assert;
use flate2::Compression;
use flate2::write::GzEncoder;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::roadgrade;

const OWN: [&str; 3] = ["smoothed", "lagged", "live"];
const ALL: [&str; 8] = [
    "smoothed",
    "lagged",
    "live",
    "original",
    "modified",
    "oracle",
    "oracle_lagged",
    "oracle_live",
];
const SHORT: &str = "seed = 5\n[road]\nlength_m = 3000.0\n[errors]\nmass_factor = 1.1\n\
    [[runs]]\nname = \"x\"\ntruck = \"A\"\n";

/// Simulates and estimates a scenario. The estimate of each run is `NAME.csv`.
fn drives(scenario: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scenario.toml");
    fs::write(&file, scenario).unwrap();
    let arguments = ["simulate", "--scenario", "scenario.toml", "--out", "."];
    roadgrade(folder.path(), &arguments).success();
    for entry in fs::read_dir(folder.path()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(run) = name.strip_suffix(".log") {
            estimate(folder.path(), run, &name);
        }
    }
    folder
}

fn estimate(folder: &Path, run: &str, log: &str) {
    let (vehicle, out) = (format!("{run}.vehicle.toml"), format!("{run}.csv"));
    let arguments = ["estimate", "--vehicle", &vehicle, "--out", &out, log];
    roadgrade(folder, &arguments).success();
}

fn score(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["score"][..], arguments].concat())
}

/// Returns the rows of the table.
fn rows(assert: Assert) -> Vec<Value> {
    let stdout = assert.success().get_output().stdout.clone();
    serde_json::from_slice(&stdout).unwrap()
}

fn estimates(rows: &[Value]) -> Vec<&str> {
    rows.iter()
        .map(|row| row["estimate"].as_str().unwrap())
        .collect()
}

fn rmse(rows: &[Value], run: &str, estimate: &str) -> f64 {
    let mut found = rows
        .iter()
        .filter(|row| row["run"] == run && row["estimate"] == estimate);
    found.next().unwrap()["rmse_percent"].as_f64().unwrap()
}

const X: [&str; 4] = ["--json", "--truth", "x.truth.csv", "x.csv"];

#[test]
fn with_a_wrong_vehicle_ours_lies_between_the_oracle_and_the_thesis() {
    let runs: String = ["a", "b"]
        .iter()
        .flat_map(|truck| [(truck, "forward"), (truck, "backward")])
        .map(|(truck, direction)| {
            format!(
                "[[runs]]\nname = \"{truck}_{direction}\"\ntruck = \"{}\"\ndirection = \
                 \"{direction}\"\n",
                truck.to_uppercase()
            )
        })
        .collect();
    let folder = drives(&format!(
        "seed = 12\n[road]\nlength_m = 20000.0\n[errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\n\
         rolling_sigma = 0.1\ntorque_sigma = 0.04\n[tyres]\ncold_amount = 0.3\n[wind]\n\
         speed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\ngust_time_s = 120.0\n{runs}"
    ));
    let names = ["a_forward", "a_backward", "b_forward", "b_backward"];
    let mut arguments = vec!["--json".to_owned()];
    for name in names {
        arguments.extend(["--truth".to_owned(), format!("{name}.truth.csv")]);
    }
    arguments.extend(names.map(|name| format!("{name}.csv")));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let rows = rows(score(folder.path(), &arguments).stderr(contains("left out: no").not()));

    assert_eq!(estimates(&rows), ALL.repeat(5));
    let mean = |estimate| rmse(&rows, "mean", estimate);
    assert!(mean("oracle") < mean("smoothed"), "{rows:?}");
    assert!(mean("oracle_lagged") < mean("lagged"), "{rows:?}");
    assert!(mean("oracle_live") < mean("live"), "{rows:?}");
    assert!(mean("smoothed") < mean("modified"), "{rows:?}");
    assert!(mean("modified") < mean("original"), "{rows:?}");
    for run in rows.chunks(8) {
        let name = run[0]["run"].as_str().unwrap();
        for (estimate, oracle) in [
            ("smoothed", "oracle"),
            ("lagged", "oracle_lagged"),
            ("live", "oracle_live"),
            ("original", "oracle"),
            ("modified", "oracle"),
        ] {
            let row = &run[ALL.iter().position(|known| *known == estimate).unwrap()];
            let expected = rmse(&rows, name, estimate) / rmse(&rows, name, oracle);
            let ratio = row["oracle_ratio"].as_f64().unwrap();
            assert!((ratio / expected - 1.0).abs() < 2e-3, "{row}");
        }
        for row in run {
            assert_eq!(row["cells"], run[0]["cells"], "{row}");
            let is_oracle = row["estimate"].as_str().unwrap().starts_with("oracle");
            assert_eq!(row["oracle_ratio"].is_null(), is_oracle, "{row}");
        }
    }
    let csv = fs::read_to_string(folder.path().join("score.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 8 * 5);
    let header = csv.lines().next().unwrap();
    assert!(header.ends_with(",nees,oracle_ratio,marked_percent,nees_unmarked"));
}

#[test]
fn an_oracle_is_not_misled_by_the_mass_on_the_bus() {
    let nearly_silent = "[noise]\nspeed_sigma_mps = 0.002\n[gnss]\naltitude_sigma_m = 10.0\n";
    let folder = drives(&format!(
        "{}{nearly_silent}",
        SHORT.replace("mass_factor = 1.1", "mass_factor = 1.4")
    ));
    // GNSS has no information about the grade here: all of it comes from mass and torque.
    let rows = rows(score(folder.path(), &X));
    assert!(rmse(&rows, "x.csv", "oracle") < 0.03, "{rows:?}");
    assert!(rmse(&rows, "x.csv", "smoothed") > 0.1, "{rows:?}");
}

#[test]
fn missing_inputs_are_left_out_and_reported() {
    let folder = drives(SHORT);
    let path = |name: &str| folder.path().join(name);
    let complete = rows(score(folder.path(), &X));
    assert_eq!(estimates(&complete), ALL);

    // vehicle.toml replaces x.vehicle.toml, and a packed log replaces a plain one.
    fs::remove_file(path("x.vehicle.toml")).unwrap();
    let mut packed = GzEncoder::new(File::create(path("x.log.gz")).unwrap(), Compression::fast());
    packed.write_all(&fs::read(path("x.log")).unwrap()).unwrap();
    packed.finish().unwrap();
    fs::rename(path("x.log"), path("kept.log")).unwrap();
    assert_eq!(rows(score(folder.path(), &X)), complete);

    fs::remove_file(path("vehicle.toml")).unwrap();
    let said = "x.csv: original and modified left out: no vehicle file";
    let left = rows(score(folder.path(), &X).stderr(contains(said)));
    assert_eq!(estimates(&left), [&ALL[..3], &ALL[5..]].concat());

    fs::rename(path("x.oracle.toml"), path("kept.oracle")).unwrap();
    let said = "x.csv: oracle left out: no oracle file";
    let left = rows(score(folder.path(), &X).stderr(contains(said)));
    assert_eq!(estimates(&left), OWN);
    assert!(left.iter().all(|row| row["oracle_ratio"].is_null()));

    fs::remove_file(path("x.log.gz")).unwrap();
    let said = "x.csv: original, modified and oracle left out: no log";
    let left = rows(score(folder.path(), &X).stderr(contains(said)));
    assert_eq!(estimates(&left), OWN);
    // Reported once for all runs.
    let twice = ["--truth", "x.truth.csv", "x.csv", "x.csv"];
    score(folder.path(), &twice)
        .success()
        .stderr(contains("x.csv and 1 more: original").count(1));

    // The same files by other names.
    let named = ["--log", "kept.log", "--oracle", "kept.oracle"];
    let left = rows(score(folder.path(), &[&named[..], &X].concat()));
    assert_eq!(left[3], complete[5]);
}

#[test]
fn an_oracle_written_by_hand_serves() {
    let folder = drives(SHORT);
    let path = |name: &str| folder.path().join(name);
    let written = fs::read_to_string(path("x.oracle.toml")).unwrap();
    let (vehicle, _) = written.split_once("[noise]").unwrap();
    let noise = "[noise]\nspeed_sigma_mps = 0.011\ngnss_white_sigma_m = 0.3\n\
        gnss_latency_s = 0.15\ngnss_slow = { sigma_m = 3.0, time_s = 250.0 }\n";
    let oracle = |noise: &str| {
        fs::write(path("x.oracle.toml"), format!("{vehicle}{noise}")).unwrap();
        let rows = rows(score(folder.path(), &X));
        let row = rows.iter().find(|row| row["estimate"] == "oracle").unwrap();
        row["nees"].as_f64().unwrap()
    };
    let bare = oracle(noise);
    // Each optional noise increases the sigma of the oracle.
    for more in [
        "force_white_sigma_n = 3000.0",
        "force_slow = { sigma_n = 2000.0, time_s = 100.0 }",
        "headwind = { sigma_mps = 5.0, time_s = 100.0 }",
        "cold_tyres = { amount = 1.0, time_s = 1500.0 }",
    ] {
        let less_sure = oracle(&format!("{noise}{more}\n"));
        assert!(less_sure < 0.97 * bare, "{more}: {less_sure} {bare}");
    }
}

#[test]
fn a_bad_oracle_is_refused_by_its_key() {
    let folder = drives(SHORT);
    let path = |name: &str| folder.path().join(name);
    let good = fs::read_to_string(path("x.oracle.toml")).unwrap();
    let refused = |bad: &str, key: &str| {
        fs::write(path("x.oracle.toml"), bad).unwrap();
        score(folder.path(), &X).code(1).stdout("").stderr(
            contains("x.oracle.toml")
                .and(contains(key))
                .and(contains("panicked").not()),
        );
        assert!(!path("score.csv").exists());
    };
    for (from, to, key) in [
        ("[noise]", "[noise]\ncolour = 3", "colour"),
        ("speed_sigma_mps = 0.011", "", "speed_sigma_mps"),
        (
            "speed_sigma_mps = 0.011",
            "speed_sigma_mps = -1.0",
            "noise.speed_sigma_mps = -1",
        ),
        (
            "speed_sigma_mps = 0.011",
            "speed_sigma_mps = nan",
            "noise.speed_sigma_mps",
        ),
        ("time_s = 250.0", "time_s = 0.0", "noise.gnss_slow.time_s"),
        ("mass_kg = 42900.0", "mass_kg = -1.0", "mass_kg"),
        ("mass_kg", "masss_kg", "masss_kg"),
        (
            "[noise]",
            "[noise.headwind]\nsigma_mps = 1.0\nfrom_deg = 3.0\ntime_s = 9.0\n[noise]",
            "from_deg",
        ),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from}");
        refused(&bad, key);
    }
    refused(good.split_once("[noise]").unwrap().0, "missing [noise]");
    refused("no toml", "x.oracle.toml");
}

#[test]
fn files_that_cannot_serve_are_errors() {
    let folder = drives(SHORT);
    let path = |name: &str| folder.path().join(name);
    for option in ["--log", "--vehicle", "--oracle"] {
        score(folder.path(), &[&X[..], &[option, "nowhere"]].concat())
            .code(1)
            .stdout("")
            .stderr(contains("nowhere: "));
        let twice = [option, "x.log", option, "x.log"];
        score(folder.path(), &[&X[..], &twice].concat())
            .code(2)
            .stderr(contains(format!("2 times {option} for 1 runs")));
    }
    // The log of another drive: refused if it is named by the user, otherwise left out.
    let other = drives(&SHORT.replace("seed = 5", "seed = 6"));
    fs::copy(other.path().join("x.log"), path("other.log")).unwrap();
    score(folder.path(), &[&X[..], &["--log", "other.log"]].concat())
        .code(1)
        .stderr(contains("other.log: shares "));
    fs::rename(path("other.log"), path("x.log")).unwrap();
    let left = rows(
        score(folder.path(), &X).stderr(contains("left out: the log beside the truth shares ")),
    );
    assert_eq!(estimates(&left), OWN);
    // A file that is not a log.
    fs::write(path("x.log"), "(0.0) can0 what#\n").unwrap();
    score(folder.path(), &X)
        .code(1)
        .stderr(contains("x.log:1: "));
}

/// Returns a log without the frames between two times, s.
fn with_hole(log: &str, from_s: f64, to_s: f64) -> String {
    let time = |line: &str| -> f64 {
        let (time, _) = line[1..].split_once(')').unwrap();
        time.parse().unwrap()
    };
    let lines = log
        .lines()
        .filter(|line| !(from_s..to_s).contains(&time(line)));
    lines.map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_gap_in_the_log_is_no_gap_in_the_comparison() {
    let folder = drives(SHORT);
    let path = |name: &str| folder.path().join(name);
    let log = fs::read_to_string(path("x.log")).unwrap();
    fs::write(path("x.log"), with_hole(&log, 60.0, 70.0)).unwrap();
    estimate(folder.path(), "x", "x.log");
    let holed = rows(score(folder.path(), &X));
    assert_eq!(estimates(&holed), ALL);
    for row in &holed {
        assert_eq!(row["cells"], holed[0]["cells"], "{row}");
        assert!(row["rmse_percent"].as_f64().unwrap() < 1.0, "{row}");
    }

    // After a late gap, the cells of the whole log are not those of the run.
    fs::write(path("late.log"), with_hole(&log, 100.0, 110.0)).unwrap();
    estimate(folder.path(), "x", "late.log");
    fs::write(path("x.log"), &log).unwrap();
    let said = contains("the log shares ").and(contains("the run itself has no ratio"));
    let partly = rows(score(folder.path(), &X).stderr(said));
    assert_eq!(estimates(&partly), ALL);
    assert!(partly[..3].iter().all(|row| row["oracle_ratio"].is_null()));
}
