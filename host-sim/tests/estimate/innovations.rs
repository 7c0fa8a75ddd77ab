//! `estimate --innovations`: measurements beside what the filter predicted.

use host_sim::files::csv::read_csv;
use host_sim::files::run;
use host_sim::recorder::{InnovationRow, Measured};
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::program as roadgrade;

/// Simulates 8 km. One altitude in the middle is 25 m off.
fn simulated(more: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let scenario = format!(
        "seed = 3\n[road]\nlength_m = 8000.0\n[gnss]\naltitude_sigma_m = 2.0\n\
         altitude_white_sigma_m = 0.3\nsteps = [[3990.0, 4010.0, 25.0]]\n{more}\n\
         [[runs]]\nname = \"a\"\ntruck = \"A\"\n"
    );
    fs::write(folder.path().join("scenario.toml"), scenario).unwrap();
    roadgrade()
        .current_dir(folder.path())
        .args(["simulate", "--scenario", "scenario.toml", "--out", "."])
        .assert()
        .success();
    folder
}

fn estimate(folder: &Path, innovations: &str, log: &str) -> assert_cmd::assert::Assert {
    roadgrade()
        .current_dir(folder)
        .args(["estimate", "--vehicle", "a.vehicle.toml", "--out", "a.csv"])
        .args(["--innovations", innovations, log])
        .assert()
}

/// Returns the innovations of a drive.
fn innovations(folder: &Path) -> Vec<InnovationRow> {
    estimate(folder, "i.csv", "a.log").success();
    read_csv(&folder.join("i.csv")).unwrap()
}

fn of(rows: &[InnovationRow], measured: Measured) -> impl Iterator<Item = &InnovationRow> {
    rows.iter().filter(move |row| row.measurement == measured)
}

/// Returns the number of measurements that were used, and the mean of their test ratios.
fn used(rows: &[InnovationRow], measured: Measured) -> (usize, f32) {
    let ratios = of(rows, measured).filter(|row| row.used == 1);
    let ratios: Vec<f32> = ratios.map(|row| row.test_ratio).collect();
    (
        ratios.len(),
        ratios.iter().sum::<f32>() / ratios.len() as f32,
    )
}

#[test]
fn normalised_innovations_have_the_variance_of_one() {
    let folder = simulated("");
    let rows = innovations(folder.path());
    for (measured, least) in [(Measured::Speed, 2_500), (Measured::Altitude, 300)] {
        let (count, ratio) = used(&rows, measured);
        assert!(count > least, "{measured:?}: {count} rows");
        assert!((0.5..1.5).contains(&ratio), "{measured:?}: {ratio}");
    }
    assert_eq!(of(&rows, Measured::Slope).count(), 0);
}

#[test]
fn rows_are_in_order_and_agree_with_the_run() {
    let folder = simulated("");
    let rows = innovations(folder.path());
    let cells = run::read(&folder.path().join("a.csv")).unwrap();
    let is_before = |a: &InnovationRow, b: &InnovationRow| {
        a.distance_m < b.distance_m
            || a.distance_m == b.distance_m && (a.measurement as u8) < b.measurement as u8
    };
    assert!(rows.is_sorted_by(is_before));
    for row in &rows {
        let cell = cells.iter().find(|cell| cell.distance_m == row.distance_m);
        let cell = cell.unwrap();
        assert_eq!(row.time_s, cell.time_s);
        let off = match row.measurement {
            Measured::Speed => f64::from(row.observation) - 0.5 * cell.speed_mps.powi(2),
            _ => f64::from(row.observation) - cell.altitude_m.unwrap(),
        };
        assert!(off.abs() < 40.0, "{row:?}");
        let ratio = row.innovation * row.innovation / row.innovation_variance;
        assert!((row.test_ratio - ratio).abs() <= 1e-5 * ratio, "{row:?}");
        assert!(row.innovation_variance >= row.variance && row.variance > 0.0);
    }
    // The drive begins with its first speed.
    assert_eq!((rows[0].measurement, rows[0].used), (Measured::Speed, 0));
    assert!(rows[1..].iter().all(|row| row.used == 1));
}

#[test]
fn an_altitude_that_is_far_off_has_a_low_weight() {
    let folder = simulated("");
    let rows = innovations(folder.path());
    let off: Vec<&InnovationRow> = of(&rows, Measured::Altitude)
        .filter(|row| row.innovation > 15.0)
        .collect();
    assert_eq!(off.len(), 1, "{off:?}");
    assert!((off[0].distance_m - 4_000.0).abs() < 20.0, "{off:?}");
    assert!(off[0].weight < 0.01, "{off:?}");
    let mut weights: Vec<f32> = of(&rows, Measured::Altitude)
        .map(|row| row.weight)
        .collect();
    weights.sort_by(f32::total_cmp);
    let median = weights[weights.len() / 2];
    assert!((0.2..5.0).contains(&median), "{median}");
}

#[test]
fn a_pitch_sensor_is_a_measurement_of_the_slope() {
    let folder = simulated("[pitch]\nnoise_sigma_deg = 0.1\n");
    let rows = innovations(folder.path());
    let (count, ratio) = used(&rows, Measured::Slope);
    assert!(count > 20, "{count} rows");
    assert!((0.02..2.0).contains(&ratio), "{ratio}");
    for row in of(&rows, Measured::Slope) {
        assert!(row.observation.abs() < 15.0, "{row:?}");
    }
}

#[test]
fn a_drive_that_fails_leaves_no_file() {
    let folder = simulated("");
    let at = folder.path();
    let files = || {
        let mut names: Vec<_> = fs::read_dir(at)
            .unwrap()
            .map(|e| e.unwrap().path())
            .collect();
        names.sort();
        names
    };
    let log = fs::read_to_string(at.join("a.log")).unwrap();
    fs::write(at.join("short.log"), &log[..2_000]).unwrap();
    let before = files();
    estimate(at, "i.csv", "short.log").failure();
    estimate(at, "i.csv", "missing.log").code(1);
    estimate(at, "no/i.csv", "a.log").code(1);
    estimate(at, "a.csv", "a.log").code(1);
    estimate(at, "a.log", "a.log").code(1);
    estimate(at, "i.parquet", "a.log").code(2);
    assert_eq!(files(), before);
    // Nor one that cannot write its run.
    fs::create_dir(at.join("a.csv")).unwrap();
    let before = files();
    estimate(at, "i.csv", "a.log").code(1);
    assert_eq!(files(), before);
}
