//! Tuning files: every parameter can be set, errors are named, and the commands use the files.

use estimator_core::Tuning;
use host_sim::files::tuning::read_or_default;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::roadgrade;

fn read(text: &str) -> Result<Tuning, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tuning.toml");
    fs::write(&path, text).unwrap();
    read_or_default(Some(&path)).map_err(|error| error.to_string())
}

/// Returns every parameter with its default, as in a user's file.
fn all_defaults() -> String {
    let mut text = String::new();
    let mut group = "";
    for parameter in Tuning::PARAMETERS {
        if parameter.group != group {
            group = parameter.group;
            text += &format!("[{group}]\n");
        }
        let default = parameter.default;
        text += &format!("{} = {default}\n", parameter.key);
    }
    text
}

#[test]
fn a_missing_key_keeps_its_default() {
    assert_eq!(read("").unwrap(), Tuning::default());
    assert_eq!(read_or_default(None).unwrap(), Tuning::default());
    assert_eq!(read(&all_defaults()).unwrap(), Tuning::default());
    let tuned = read("[detection]\nfrozen_readings = 5\n[hold_times]\nhold_ms = 1500\n").unwrap();
    let mut expected = Tuning::default();
    expected.detection.frozen_readings = 5;
    expected.hold_times.hold = estimator_core::Duration::from_millis(1_500);
    assert_eq!(tuned, expected);
}

#[test]
fn errors_name_the_expected_value() {
    for (text, named) in [
        (
            "[gate]\n",
            "[gate]: unknown table; expected one of estimation, ",
        ),
        ("prior = 1\n", "prior: expected a table"),
        (
            "[prior]\nscale = 1\n",
            "prior.scale: unknown key; expected one of torque_sigma, ",
        ),
        (
            "[detection]\nfrozen_readings = 2.5\n",
            "detection.frozen_readings = 2.5: expected a whole number",
        ),
        (
            "[detection]\nfrozen_readings = 0\n",
            "detection.frozen_readings = 0: expected a value from 1 to 255",
        ),
        (
            "[prior]\nkept_bias = \"4\"\n",
            "prior.kept_bias = \"4\": expected a number",
        ),
        (
            "[prior]\nkept_bias = nan\n",
            "prior.kept_bias = nan: expected a value from",
        ),
        ("[prior\n", "TOML parse error"),
    ] {
        let refusal = read(text).unwrap_err();
        assert!(refusal.contains(named), "{text}: {refusal}");
        assert!(refusal.contains("tuning.toml"), "{refusal}");
    }
}

/// Writes the logs of the demonstration.
fn demo(folder: &Path) {
    roadgrade(folder, &["demo", "--out", "demo"]).success();
}

fn estimate(folder: &Path, out: &str, tuning: &[&str]) -> Vec<u8> {
    let vehicle = ["--vehicle", "demo/a1.vehicle.toml"];
    let arguments = [
        &["estimate"][..],
        &vehicle,
        tuning,
        &["--out", out, "demo/a1.log"],
    ]
    .concat();
    roadgrade(folder, &arguments).success();
    fs::read(folder.join(out)).unwrap()
}

#[test]
fn estimates_use_the_file() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    demo(at);
    fs::write(at.join("defaults.toml"), all_defaults()).unwrap();
    fs::write(
        at.join("stiff.toml"),
        "[estimation]\nslope_rate_noise = 0.002\n",
    )
    .unwrap();
    let plain = estimate(at, "plain.csv", &[]);
    assert!(plain == estimate(at, "defaults.csv", &["--tuning", "defaults.toml"]));
    assert!(plain != estimate(at, "stiff.csv", &["--tuning", "stiff.toml"]));
}

#[test]
fn a_wrong_file_is_refused_before_anything_is_written() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    demo(at);
    fs::write(at.join("wrong.toml"), "[prior]\ntorque_sigma = -1\n").unwrap();
    let refused = || contains("wrong.toml").and(contains("prior.torque_sigma = -1"));
    let tuning = ["--tuning", "wrong.toml"];
    let vehicle = ["--vehicle", "demo/a1.vehicle.toml"];
    for (command, rest) in [
        (&["estimate"][..], &["--out", "run.csv", "demo/a1.log"][..]),
        (&["diagnose"], &["--out", "run.csv", "demo/a1.log"]),
    ] {
        let arguments = [command, &vehicle, &tuning, rest].concat();
        roadgrade(at, &arguments).code(1).stderr(refused());
        assert!(!at.join("run.csv").exists());
    }
    let arguments = [&["demo", "--out", "other"][..], &tuning].concat();
    roadgrade(at, &arguments).code(1).stderr(refused());
    assert!(!at.join("other").exists());
}
