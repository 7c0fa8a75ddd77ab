//! `roadgrade diagnose` from end to end: what it writes, and what it refuses.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use test_kit::command::program as roadgrade;

/// Short drives of one truck. Its rolling resistance is 30 % larger than in its vehicle file.
struct Drives {
    folder: TempDir,
    vehicle: PathBuf,
    logs: [PathBuf; 3],
}

/// Simulated once for all tests.
fn drives() -> &'static Drives {
    static DRIVES: OnceLock<Drives> = OnceLock::new();
    DRIVES.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        let scenario = folder.path().join("scenario.toml");
        let run = |name: &str, direction: &str| {
            format!("[[runs]]\nname = \"{name}\"\ntruck = \"A\"\ndirection = \"{direction}\"\n")
        };
        let text = format!(
            "seed = 5\n[road]\nlength_m = 8000.0\n[errors]\nrolling_factor = 1.3\n{}{}{}",
            run("one", "forward"),
            run("two", "backward"),
            run("three", "forward")
        );
        fs::write(&scenario, text).unwrap();
        roadgrade()
            .args(["simulate", "--scenario"])
            .arg(&scenario)
            .arg("--out")
            .arg(folder.path())
            .assert()
            .success();
        let file = |name: &str| folder.path().join(name);
        Drives {
            vehicle: file("one.vehicle.toml"),
            logs: ["one.log", "two.log", "three.log"].map(file),
            folder,
        }
    })
}

/// Returns the command `roadgrade diagnose --vehicle VEHICLE --out OUT`.
fn diagnose(vehicle: &Path, out: &Path) -> Command {
    let mut command = roadgrade();
    command.args(["diagnose", "--vehicle"]).arg(vehicle);
    command.arg("--out").arg(out);
    command
}

fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().unwrap();
    object.keys().map(String::as_str).collect()
}

fn assert_keys(value: &Value, expected: &[&str]) {
    let keys = keys(value);
    for key in expected {
        assert!(keys.contains(key), "{key} is not in {keys:?}");
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_report_a_vehicle_and_a_page_are_written() {
    let Drives {
        folder,
        vehicle,
        logs: [one, two, three],
    } = drives();
    let out = folder.path().join("found");
    let run = diagnose(vehicle, &out)
        .arg("--json")
        .args([one, two])
        .arg("--holdout")
        .arg(three)
        .assert()
        .success();
    let text = fs::read_to_string(out.join("report.json")).unwrap();
    assert_eq!(text.as_bytes(), run.get_output().stdout);
    let report: Value = serde_json::from_str(&text).unwrap();

    assert_keys(
        &report,
        &["adopted", "candidates", "before", "after", "unexplained"],
    );
    let adopted = report["adopted"].as_array().unwrap();
    assert!(!adopted.is_empty(), "a rolling resistance of 30 % more");
    for one in adopted {
        assert_keys(one, &["name", "amount", "sigma", "unit"]);
        assert!(number(&one["sigma"]) > 0.0, "{one}");
    }
    let candidates = report["candidates"].as_array().unwrap();
    assert!(candidates.len() > 5, "{}", candidates.len());
    for one in candidates {
        assert_keys(one, &["name", "amount", "sigma", "evidence"]);
        assert_eq!(
            one["holdout_before_percent"],
            report["before"]["rmse_percent"]
        );
        assert!(one["holdout_after_percent"].is_number(), "{one}");
    }
    for judged in ["before", "after"] {
        assert_keys(&report[judged], &["rmse_percent", "bias_percent"]);
    }
    assert_keys(&report["unexplained"], &["rms_percent", "depends_on"]);
    // The vehicle file lacks 0.3 x 0.0065.
    let (before, after) = (&report["before"], &report["after"]);
    assert!(
        (number(&before["bias_percent"]) - 0.195).abs() < 0.05,
        "{before}"
    );
    assert!(number(&after["bias_percent"]).abs() < 0.06, "{after}");
    assert!(2.0 * number(&after["rmse_percent"]) < number(&before["rmse_percent"]));

    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let name = adopted[0]["name"].as_str().unwrap();
    assert!(page.contains(name) && page.contains("data-residual"));

    // The written vehicle file has the adopted effects and is read back.
    let with_effects = out.join("vehicle.toml");
    let text = fs::read_to_string(&with_effects).unwrap();
    for one in adopted {
        let table = format!("[effects.{}]", one["name"].as_str().unwrap());
        assert!(text.contains(&table), "{table} is not in {text}");
    }
    let estimate = |vehicle: &Path, name: &str| {
        let csv = folder.path().join(name);
        roadgrade()
            .args(["estimate", "--vehicle"])
            .arg(vehicle)
            .arg("--out")
            .arg(&csv)
            .arg(three)
            .assert()
            .success();
        fs::read(csv).unwrap()
    };
    assert_ne!(
        estimate(vehicle, "bare.csv"),
        estimate(&with_effects, "with.csv")
    );
}

#[test]
fn the_same_drives_give_the_same_bytes_and_a_table() {
    let Drives {
        folder,
        vehicle,
        logs: [one, two, _],
    } = drives();
    let report = |name: &str| {
        let out = folder.path().join(name);
        diagnose(vehicle, &out)
            .args([one, two])
            .assert()
            .success()
            .stdout(contains("rolling_resistance").and(contains("were fitted too")))
            .stderr(contains("report.html"));
        ["report.json", "vehicle.toml", "report.html"].map(|file| fs::read(out.join(file)).unwrap())
    };
    assert!(report("first") == report("second"));
}

/// Checks that the command fails with this exit code, has all of `words` in its message, and
/// writes nothing.
fn refused(command: &mut Command, out: &Path, code: i32, words: &[&str]) {
    let run = command.assert().code(code).stdout("");
    let message = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    for word in words {
        assert!(message.contains(word), "{word} is not in: {message}");
    }
    assert!(!out.exists(), "{} was written", out.display());
}

/// Returns a folder, and the path of an output folder in it that does not exist yet.
fn scratch() -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    (folder, out)
}

#[test]
fn wrong_usage_exits_with_2() {
    let Drives { vehicle, logs, .. } = drives();
    let (_folder, out) = scratch();
    refused(&mut diagnose(vehicle, &out), &out, 2, &["<LOG>..."]);
    let mut empty_holdout = diagnose(vehicle, &out);
    empty_holdout.args(logs).arg("--holdout");
    refused(&mut empty_holdout, &out, 2, &["--holdout"]);
    let mut no_vehicle = roadgrade();
    no_vehicle.arg("diagnose").arg("--out").arg(&out).args(logs);
    refused(&mut no_vehicle, &out, 2, &["--vehicle"]);
}

#[test]
fn logs_that_are_missing_or_broken_are_named() {
    let Drives {
        vehicle,
        logs: [one, two, _],
        ..
    } = drives();
    let (folder, out) = scratch();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let missing = folder.path().join("missing.log");
    let standing: String = (0..200)
        .map(|row| format!("{},0.0,0.0\n", 0.1 * f64::from(row)))
        .collect();
    let standing = file(
        "standing.csv",
        &format!("time_s,wheel_speed_mps,traction_force_n\n{standing}"),
    );
    let empty = file("empty.log", "");
    let broken = file(
        "broken.log",
        "(1.0) can0 0CF00400#01\n(1.1) can0 what is this\n",
    );
    for (log, words) in [
        (&missing, ["missing.log", "No such file"]),
        (&standing, ["standing.csv", "does not move"]),
        (&empty, ["empty.log", ""]),
        (&broken, ["broken.log:2", "expected 3 hexadecimal digits"]),
    ] {
        refused(diagnose(vehicle, &out).arg(one).arg(log), &out, 1, &words);
    }
    let mut held_out = diagnose(vehicle, &out);
    held_out.args([one, two]).arg("--holdout").arg(&missing);
    refused(&mut held_out, &out, 1, &["missing.log"]);
    let mut twice = diagnose(vehicle, &out);
    twice.args([one, two]).arg("--holdout").arg(one);
    refused(&mut twice, &out, 1, &["given twice"]);
}

#[test]
fn impossible_vehicles_and_references_are_named() {
    let Drives { vehicle, logs, .. } = drives();
    let (folder, out) = scratch();
    let text = fs::read_to_string(vehicle).unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let key = text.replace("[vehicle]", "[vehicle]\nwheels = 6");
    let unknown = write("unknown.toml", &key);
    refused(
        diagnose(&unknown, &out).args(logs),
        &out,
        1,
        &["unknown.toml", "wheels"],
    );
    let effect = format!("{text}\n[effects.gravity]\namount = 0.1\namount_sigma = 0.1\n");
    let effect = write("effect.toml", &effect);
    refused(
        diagnose(&effect, &out).args(logs),
        &out,
        1,
        &["effect.toml", "gravity"],
    );
    let map = write("map.csv", "distance_m,grade\n0,1\n");
    let mut with_map = diagnose(vehicle, &out);
    with_map.args(logs).arg("--reference").arg(&map);
    refused(&mut with_map, &out, 1, &["map.csv"]);
    let mut without_map = diagnose(vehicle, &out);
    let nowhere = folder.path().join("nowhere.csv");
    without_map.args(logs).arg("--reference").arg(&nowhere);
    refused(&mut without_map, &out, 1, &["nowhere.csv"]);
    // A map of another road, a degree further north.
    let rows = (0..400).map(|cell| {
        let north_deg = 60.0 + 2.5e-5 * f64::from(cell);
        format!(
            "{},{north_deg},17.0,10.0,1.0,0.1,1\n",
            2.5 * f64::from(cell)
        )
    });
    let header = "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent,\
                  grade_sigma_percent,runs\n";
    let elsewhere = write(
        "elsewhere.csv",
        &(header.to_owned() + &rows.collect::<String>()),
    );
    let mut on_another_road = diagnose(vehicle, &out);
    on_another_road
        .args(logs)
        .arg("--reference")
        .arg(&elsewhere);
    refused(
        &mut on_another_road,
        &out,
        1,
        &["elsewhere.csv", "no drive is on this road"],
    );
}

#[test]
fn existing_output_is_kept_after_a_failure() {
    let Drives { vehicle, logs, .. } = drives();
    let (folder, out) = scratch();
    fs::create_dir(&out).unwrap();
    let kept = out.join("report.json");
    fs::write(&kept, "as it was").unwrap();
    diagnose(vehicle, &out)
        .args(logs)
        .arg(folder.path().join("missing.log"))
        .assert()
        .code(1);
    let names: Vec<_> = fs::read_dir(&out).unwrap().collect();
    assert_eq!(names.len(), 1);
    assert_eq!(fs::read_to_string(&kept).unwrap(), "as it was");
}

#[test]
fn an_impossible_output_folder_is_named() {
    let Drives { vehicle, logs, .. } = drives();
    let (_folder, out) = scratch();
    fs::write(&out, "no folder").unwrap();
    diagnose(vehicle, &out)
        .arg(&logs[0])
        .assert()
        .code(1)
        .stdout("")
        .stderr(contains(out.to_str().unwrap()));
    assert_eq!(fs::read_to_string(&out).unwrap(), "no folder");
}
