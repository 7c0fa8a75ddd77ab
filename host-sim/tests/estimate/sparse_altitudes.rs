//! Altitudes minutes apart, as telematics report them: they teach the bias of the model, and few of
//! them are enough for an estimate.

use std::fmt::Write as _;
use test_kit::command::{folder, program};
use test_kit::tables::columns;

const VEHICLE: &str = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
    rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
    [traction]\nsource = \"force\"\n";

/// Returns 40 minutes on a level road at 25 m/s, with a force that tells 0.5 % uphill, and an
/// altitude at these times, s.
fn table(altitudes_s: &[usize]) -> String {
    let mut text = "time_s,wheel_speed_mps,traction_force_n,mass_kg,altitude_m\n".to_owned();
    let level_n = 39_000.0 * 9.806_65 * 0.0065 + 0.5 * 1.225 * 6.0 * 25.0 * 25.0;
    let force_n = level_n + 39_000.0 * 9.806_65 * 0.005;
    for time_s in 0..2_400 {
        let altitude = if altitudes_s.contains(&time_s) {
            "400"
        } else {
            ""
        };
        writeln!(text, "{time_s},25.0,{force_n:.0},39000,{altitude}").unwrap();
    }
    text
}

/// Estimates the drive. Returns the mean smoothed grade between the first and the last 5 km, %.
fn mean_grade_percent(altitudes_s: &[usize]) -> f64 {
    let folder = folder();
    std::fs::write(folder.path().join("a.toml"), VEHICLE).unwrap();
    std::fs::write(folder.path().join("a.csv"), table(altitudes_s)).unwrap();
    program()
        .current_dir(folder.path())
        .args([
            "estimate",
            "--vehicle",
            "a.toml",
            "--out",
            "run.csv",
            "a.csv",
        ])
        .assert()
        .success();
    let run = columns(&folder.path().join("run.csv"));
    let grades: Vec<f64> = run["grade_percent"]
        .iter()
        .map(|of| of.parse().unwrap())
        .collect();
    let middle = &grades[2_000..grades.len() - 2_000];
    middle.iter().sum::<f64>() / middle.len() as f64
}

#[test]
fn altitudes_minutes_apart_teach_the_bias() {
    let every_320_s: Vec<usize> = (20..2_400).step_by(320).collect();
    let grade_percent = mean_grade_percent(&every_320_s);
    assert!(grade_percent.abs() < 0.05, "{grade_percent}");
}

#[test]
fn three_altitudes_of_a_drive_teach_it_too() {
    let grade_percent = mean_grade_percent(&[20, 1_000, 2_000]);
    assert!(grade_percent.abs() < 0.05, "{grade_percent}");
}
