//! The accelerometer as evidence and as judge, on drives made by hand.

use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::program as roadgrade;

const GRAVITY_MPS2: f64 = 9.806_65;
const MASS_KG: f64 = 1_500.0;
const ROLLING: f64 = 0.01;
const DRAG_AREA_M2: f64 = 0.7;
/// What the vehicle file lacks: a part of the rolling resistance a kelvin below 25 °C.
const COLD_PER_K: f64 = 0.02;
const VEHICLE: &str = "[vehicle]\nname = \"car\"\nmass_kg = 1500.0\ndrag_area_m2 = 0.7\n\
    rolling_resistance = 0.01\nwheel_radius_m = 0.35\nwheel_inertia_kgm2 = 0.0\n\
    [traction]\nsource = \"force\"\n";

/// Writes a drive of 15 minutes at 10 Hz over hills, with no altitude, and an accelerometer that is
/// off by this.
fn drive(path: &Path, ambient_celsius: f64, offset_mps2: f64) {
    let mut text = "time_s,wheel_speed_mps,traction_force_n,ambient_celsius,\
                    longitudinal_acceleration_mps2\n"
        .to_owned();
    let mut driven_m = 0.0;
    for tick in 0..9_000 {
        let time_s = 0.1 * f64::from(tick);
        let speed_mps = 16.0 + 4.0 * (0.03 * time_s).sin();
        let gain_mps2 = 4.0 * 0.03 * (0.03 * time_s).cos();
        let sine = 0.02 * (driven_m / 300.0_f64).sin();
        let cold = 1.0 + COLD_PER_K * (25.0 - ambient_celsius);
        let force_n = MASS_KG * (gain_mps2 + GRAVITY_MPS2 * (sine + ROLLING * cold))
            + 0.6 * DRAG_AREA_M2 * speed_mps * speed_mps;
        let reading_mps2 = gain_mps2 + GRAVITY_MPS2 * sine + offset_mps2;
        let noise_mps2 = 0.2 * (7.7 * f64::from(tick)).sin();
        writeln!(
            text,
            "{time_s:.1},{speed_mps:.3},{force_n:.1},{ambient_celsius},{:.3}",
            reading_mps2 + noise_mps2
        )
        .unwrap();
        driven_m += 0.1 * speed_mps;
    }
    fs::write(path, text).unwrap();
}

/// Two drives in summer and three in winter, and the vehicle file.
fn drives() -> (TempDir, PathBuf, Vec<PathBuf>) {
    let folder = TempDir::new().unwrap();
    let vehicle = folder.path().join("vehicle.toml");
    fs::write(&vehicle, VEHICLE).unwrap();
    let kinds = [
        (25.0, 0.004),
        (24.0, -0.006),
        (0.0, 0.005),
        (2.0, -0.003),
        (1.0, 0.02),
    ];
    let logs = kinds
        .iter()
        .enumerate()
        .map(|(number, (celsius, offset_mps2))| {
            let log = folder.path().join(format!("drive{number}.csv"));
            drive(&log, *celsius, *offset_mps2);
            log
        })
        .collect();
    (folder, vehicle, logs)
}

fn mean(judgement: &Value, of: &str) -> f64 {
    judgement["drives"][0][of]["mean_percent"].as_f64().unwrap()
}

#[test]
fn it_finds_what_winter_adds_and_judges_before_and_after() {
    let (folder, vehicle, logs) = drives();
    let out = folder.path().join("found");
    roadgrade()
        .args(["diagnose", "--vehicle"])
        .arg(&vehicle)
        .arg("--out")
        .arg(&out)
        .args(["--reference-signal", "longitudinal_acceleration_mps2"])
        .args(&logs[..4])
        .arg("--holdout")
        .arg(&logs[4])
        .assert()
        .success()
        .stdout(contains("Against the accelerometer").and(contains("smoothed")));
    let report: Value =
        serde_json::from_str(&fs::read_to_string(out.join("report.json")).unwrap()).unwrap();
    let adopted = report["adopted"].as_array().unwrap();
    let of_name = |name: &str| adopted.iter().find(|one| one["name"] == name);
    let cold = of_name("tyre_temperature").unwrap_or_else(|| panic!("{adopted:?}"));
    let (amount, sigma) = (&cold["amount"], &cold["sigma"]);
    let (amount, sigma) = (amount.as_f64().unwrap(), sigma.as_f64().unwrap());
    assert!(
        (amount - COLD_PER_K).abs() < 3.0 * sigma,
        "{amount} ± {sigma}"
    );
    assert!(sigma < 0.5 * COLD_PER_K, "{sigma}");

    let judged = &report["reference_signal"];
    assert_eq!(judged["signal"], "longitudinal_acceleration_mps2");
    assert_eq!(judged["before"]["drives"][0]["log"], "drive4.csv");
    // The file lacks 0.02 × 24 K × 0.01 = 0.48 %; the sensor is off by 0.2 %.
    let before = mean(&judged["before"], "bare");
    assert!((before - (0.48 - 0.2)).abs() < 0.03, "{before}");
    let after = mean(&judged["after"], "bare");
    assert!((after + 0.2).abs() < 0.15, "{after}");
    let rms = judged["before"]["bare"]["median_rms_percent"].as_f64();
    assert!(rms.unwrap() < 0.05, "{judged}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Against the accelerometer") && page.contains("drive4.csv"));
}

#[test]
fn estimates_do_not_see_it() {
    let (folder, vehicle, logs) = drives();
    let smoothed = |logs: &[PathBuf], name: &str| {
        let out = folder.path().join(name);
        roadgrade()
            .args(["diagnose", "--vehicle"])
            .arg(&vehicle)
            .arg("--out")
            .arg(&out)
            .args(["--reference-signal", "longitudinal_acceleration_mps2"])
            .args(logs)
            .assert()
            .success();
        let text = fs::read_to_string(out.join("report.json")).unwrap();
        let report: Value = serde_json::from_str(&text).unwrap();
        mean(&report["reference_signal"]["before"], "smoothed")
    };
    // The same drive with another sensor: the estimate stays, so all of the offset shows.
    let other = folder.path().join("other.csv");
    drive(&other, 25.0, 0.104);
    let [one, other] = [&logs[0], &other].map(|log| {
        let name = log.file_stem().unwrap().to_str().unwrap().to_owned();
        smoothed(std::slice::from_ref(log), &format!("of_{name}"))
    });
    let expected = -100.0 * 0.1 / GRAVITY_MPS2;
    assert!((other - one - expected).abs() < 0.02, "{one} {other}");
}

#[test]
fn drives_without_it_and_other_signals_are_refused() {
    let (folder, vehicle, logs) = drives();
    let out = folder.path().join("out");
    let text = fs::read_to_string(&logs[0]).unwrap();
    let text = text.replace("longitudinal_acceleration_mps2", "acceleration");
    let without = folder.path().join("without.csv");
    fs::write(&without, text).unwrap();
    let diagnose = |signal: &str, log: &Path| {
        let mut command = roadgrade();
        command.args(["diagnose", "--vehicle"]).arg(&vehicle);
        command.arg("--out").arg(&out);
        command.args(["--reference-signal", signal]).arg(log);
        command.assert()
    };
    diagnose("longitudinal_acceleration_mps2", &without)
        .code(1)
        .stderr(contains("without.csv").and(contains("longitudinal_acceleration_mps2")));
    diagnose("pitch_deg", &logs[0])
        .code(2)
        .stderr(contains("longitudinal_acceleration_mps2"));
    let mut no_tile = roadgrade();
    no_tile.args(["diagnose", "--vehicle"]).arg(&vehicle);
    no_tile.arg("--out").arg(&out).arg("--terrain");
    no_tile.arg(folder.path().join("nowhere")).arg(&logs[0]);
    // Without positions there is nothing to look up.
    no_tile.assert().success();
}
