//! The engine's own reference torque (EC1) against a vehicle file that has another one.

use host_sim::files::run;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::program as roadgrade;

const SCENARIO: &str =
    "seed = 3\n[road]\nlength_m = 4000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";

fn estimate(vehicle: &Path, log: &Path, out: &Path) -> assert_cmd::assert::Assert {
    roadgrade()
        .args(["estimate", "--vehicle"])
        .arg(vehicle)
        .arg("--out")
        .arg(out)
        .arg(log)
        .assert()
        .success()
}

#[test]
fn the_bus_goes_before_the_file_and_is_told() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("scenario.toml"), SCENARIO).unwrap();
    roadgrade()
        .args(["simulate", "--scenario"])
        .arg(file("scenario.toml"))
        .arg("--out")
        .arg(folder.path())
        .assert()
        .success();
    let (log, vehicle) = (file("a.log"), file("a.vehicle.toml"));
    let told = "EC1 says reference_torque_nm = 1750 Nm, the vehicle file 1500 Nm: the bus is used";
    estimate(&vehicle, &log, &file("right.csv")).stderr(contains("EC1").not());

    let text = fs::read_to_string(&vehicle).unwrap();
    let wrong = text.replace(
        "reference_torque_nm = 1750.0",
        "reference_torque_nm = 1500.0",
    );
    assert_ne!(wrong, text);
    fs::write(file("wrong.toml"), wrong).unwrap();
    estimate(&file("wrong.toml"), &log, &file("wrong.csv"))
        .stderr(contains(told))
        .stdout(contains("parameters replaced by the bus"));
    let (right, wrong) = (file("right.csv"), file("wrong.csv"));
    let (right, wrong) = (run::read(&right).unwrap(), run::read(&wrong).unwrap());
    // Behind the first two broadcasts, 7 s, nothing is left of the difference: live, at 1 km.
    let live = |rows: &[run::RunRow]| rows[400..].to_vec();
    let squares: f64 = live(&right)
        .iter()
        .zip(live(&wrong))
        .map(|(a, b)| (a.live_grade_percent - b.live_grade_percent).powi(2))
        .sum();
    let rms = (squares / live(&right).len() as f64).sqrt();
    assert!(rms < 0.05, "{rms} %");
}
