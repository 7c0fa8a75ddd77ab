//! `roadgrade estimate` from end to end: its accuracy, and what it refuses.

use host_sim::files::run::{self, RunRow};
use host_sim::files::truth;
use host_sim::score::score_run;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::program as roadgrade;

fn simulate(folder: &Path, scenario: &str) {
    let file = folder.join("scenario.toml");
    fs::write(&file, scenario).unwrap();
    roadgrade()
        .args(["simulate", "--scenario"])
        .arg(&file)
        .arg("--out")
        .arg(folder)
        .assert()
        .success();
}

fn estimate(vehicle: &Path, log: &Path, out: &Path) -> assert_cmd::assert::Assert {
    roadgrade()
        .args(["estimate", "--vehicle"])
        .arg(vehicle)
        .arg("--out")
        .arg(out)
        .arg(log)
        .assert()
}

const MOTORWAY: &str = include_str!("../../scenarios/motorway.toml");

#[test]
fn forty_km_with_right_parameters_are_within_the_bounds() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name);
    simulate(folder.path(), MOTORWAY);
    for (run, bar) in [
        ("a_forward", 0.08),
        ("a_backward", 0.08),
        ("b_forward", 0.12),
        ("b_backward", 0.12),
    ] {
        let out = file(&format!("{run}.csv"));
        estimate(
            &file(&format!("{run}.vehicle.toml")),
            &file(&format!("{run}.log")),
            &out,
        )
        .success();
        let rows = run::read(&out).unwrap();
        let truth = truth::read(&file(&format!("{run}.truth.csv"))).unwrap();
        let scores = score_run(run, &rows, &truth).unwrap().rows;
        assert!(scores[0].rmse_percent <= bar, "{:?}", scores[0]);
        for score in &scores {
            assert!((0.15..=2.0).contains(&score.nees), "{score:?}");
        }
    }
}

/// Simulates 3 km of truck A. Returns the folder, the log and the vehicle file.
fn short_drive() -> (TempDir, PathBuf, PathBuf) {
    let folder = TempDir::new().unwrap();
    simulate(
        folder.path(),
        "seed = 3\n[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n",
    );
    let log = folder.path().join("a.log");
    let vehicle = folder.path().join("a.vehicle.toml");
    (folder, log, vehicle)
}

fn rms(a: &[RunRow], b: &[RunRow], value: fn(&RunRow) -> f64) -> f64 {
    assert_eq!(a.len(), b.len());
    let squares: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| (value(a) - value(b)).powi(2))
        .sum();
    (squares / a.len() as f64).sqrt()
}

#[test]
fn single_precision_is_double_precision_within_two_thousandths() {
    let (folder, log, vehicle) = short_drive();
    let (single, double) = (folder.path().join("f32.csv"), folder.path().join("f64.csv"));
    estimate(&vehicle, &log, &single).success();
    roadgrade()
        .args(["estimate", "--double", "--vehicle"])
        .arg(&vehicle)
        .arg("--out")
        .arg(&double)
        .arg(&log)
        .assert()
        .success();
    let (single, double) = (run::read(&single).unwrap(), run::read(&double).unwrap());
    let grades: [fn(&RunRow) -> f64; 3] = [
        |row| row.grade_percent,
        |row| row.lagged_grade_percent,
        |row| row.live_grade_percent,
    ];
    for grade in grades {
        let difference = rms(&single, &double, grade);
        assert!(difference <= 0.002, "{difference} %");
    }
}

#[test]
fn same_log_same_bytes_whatever_its_layout() {
    let (folder, log, vehicle) = short_drive();
    let run = |log: &Path, name: &str| {
        let out = folder.path().join(name);
        estimate(&vehicle, log, &out).success();
        fs::read(out).unwrap()
    };
    let first = run(&log, "1.csv");
    assert_eq!(first, run(&log, "2.csv"));

    let screen = folder.path().join("screen.log");
    let text = fs::read_to_string(&log).unwrap();
    let lines: String = text.lines().map(in_screen_layout).collect();
    fs::write(&screen, lines).unwrap();
    assert_eq!(first, run(&screen, "3.csv"));
}

/// Returns `(1.0) can0 0CF00400#0102` as `(1.0)  can0  0CF00400   [2]  01 02`.
fn in_screen_layout(line: &str) -> String {
    let mut words = line.split(' ');
    let (time, interface) = (words.next().unwrap(), words.next().unwrap());
    let (id, data) = words.next().unwrap().split_once('#').unwrap();
    let bytes: Vec<&str> = (0..data.len() / 2)
        .map(|k| &data[2 * k..2 * k + 2])
        .collect();
    format!(
        " {time}  {interface}  {id}   [{}]  {}\n",
        bytes.len(),
        bytes.join(" ")
    )
}

/// Writes the lines of the log for which `keep` returns true to another log.
fn filtered(log: &Path, name: &str, keep: impl Fn(&str) -> bool) -> PathBuf {
    let text = fs::read_to_string(log).unwrap();
    let kept: String = text
        .lines()
        .filter(|line| keep(line))
        .map(|line| format!("{line}\n"))
        .collect();
    let path = log.with_file_name(name);
    fs::write(&path, kept).unwrap();
    path
}

/// Returns whether the identifier is of this parameter group, PDU2.
fn is_group(line: &str, pgn: u32) -> bool {
    let id = line.split(' ').nth(2).unwrap().split('#').next().unwrap();
    u32::from_str_radix(id, 16).is_ok_and(|id| (id >> 8) & 0x3_ffff == pgn)
}

/// Without any altitude, a wrong force balance shows nowhere. The sigma must have it from the start.
#[test]
fn a_drive_without_altitude_has_a_sigma_that_contains_a_wrong_force_balance() {
    let (folder, log, vehicle) = short_drive();
    let right = fs::read_to_string(&vehicle).unwrap();
    let mut document: toml::Table = right.parse().unwrap();
    let parameters = document["vehicle"].as_table_mut().unwrap();
    let mass_kg = parameters["mass_kg"].as_float().unwrap();
    parameters.insert("mass_kg".into(), (1.1 * mass_kg).into());
    fs::write(&vehicle, document.to_string()).unwrap();
    let out = folder.path().join("run.csv");
    roadgrade()
        .args(["estimate", "--ignore", "altitude_m", "--vehicle"])
        .arg(&vehicle)
        .arg("--out")
        .arg(&out)
        .arg(&log)
        .assert()
        .success();
    let truth = truth::read(&folder.path().join("a.truth.csv")).unwrap();
    let rows = run::read(&out).unwrap();
    for score in score_run("a", &rows, &truth).unwrap().rows {
        assert!(score.rmse_percent < 1.0 && score.nees < 1.5, "{score:?}");
    }
    assert!(
        rows.iter()
            .all(|row| row.altitude_sigma_m.is_none_or(|sigma_m| sigma_m > 100.0))
    );
}

#[test]
fn logs_that_lack_what_is_needed_are_refused_by_name() {
    let (folder, log, vehicle) = short_drive();
    let out = folder.path().join("run.csv");
    let refused = |log: &Path, words: &str| {
        estimate(&vehicle, log, &out)
            .code(1)
            .stderr(contains(words).and(contains(log.file_name().unwrap().to_str().unwrap())));
        assert!(!out.exists(), "an output in spite of: {words}");
    };
    refused(
        &filtered(&log, "no_gnss.log", |line| !is_group(line, 129_029)),
        "no GNSS altitude",
    );
    refused(
        &filtered(&log, "no_torque.log", |line| !is_group(line, 61_444)),
        "no engine torque",
    );
    refused(
        &filtered(&log, "no_speed.log", |line| {
            !is_group(line, 65_265) && !is_group(line, 65_215)
        }),
        "no speed",
    );

    let empty = folder.path().join("empty.log");
    fs::write(&empty, "").unwrap();
    refused(&empty, "empty");
    let binary = folder.path().join("binary.log");
    fs::write(
        &binary,
        (0..=255_u8).cycle().take(5000).collect::<Vec<u8>>(),
    )
    .unwrap();
    refused(&binary, "unknown format, begins with `");
    let prose = folder.path().join("prose.log");
    fs::write(&prose, "Dear truck,\nhow are you?\n").unwrap();
    refused(&prose, "unknown format, begins with `Dear truck,`");
    refused(&folder.path().join("absent.log"), "No such file");
}

#[test]
fn a_log_that_is_cut_off_is_used_up_to_there() {
    let (folder, log, vehicle) = short_drive();
    let out = folder.path().join("run.csv");
    let text = fs::read_to_string(&log).unwrap();
    let cut = folder.path().join("cut.log");
    fs::write(&cut, &text[..text.len() - 9]).unwrap();
    estimate(&vehicle, &cut, &out)
        .success()
        .stderr(contains("cut.log: used up to where it is cut off"));
    assert!(out.exists());
}

#[test]
fn a_log_without_optional_signals_is_estimated() {
    let (folder, log, vehicle) = short_drive();
    let out = folder.path().join("run.csv");
    // No gear: it is computed from engine and wheel speed. No second speed, no ambient conditions.
    let bare = filtered(&log, "bare.log", |line| {
        [61_444, 65_247, 65_265, 129_029]
            .iter()
            .any(|pgn| is_group(line, *pgn))
    });
    estimate(&vehicle, &bare, &out).success();
    let rows = run::read(&out).unwrap();
    let truth = truth::read(&folder.path().join("a.truth.csv")).unwrap();
    let score = &score_run("a", &rows, &truth).unwrap().rows[0];
    assert!(score.rmse_percent < 0.25, "{score:?}");
}

#[test]
fn wrong_vehicle_files_are_refused_by_key() {
    let (folder, log, vehicle) = short_drive();
    let good = fs::read_to_string(&vehicle).unwrap();
    let out = folder.path().join("run.csv");
    let bad = folder.path().join("bad.toml");
    let gears = &good[good.find("gears").unwrap_or(0)..];
    assert!(!gears.is_empty());
    for (text, words) in [
        (good.replace("mass_kg", "mass_tons"), "mass_tons"),
        (
            good.replace("[vehicle]", "[vehicle]\ncolour = \"red\""),
            "colour",
        ),
        (
            good.replace("mass_kg = 39000.0", "mass_kg = -1.0"),
            "vehicle.mass_kg",
        ),
        (
            good.replace("mass_kg = 39000.0", "mass_kg = nan"),
            "vehicle.mass_kg",
        ),
        (
            good.replace("mass_kg = 39000.0", "mass_kg = \"heavy\""),
            "mass_kg",
        ),
        (without_gears(&good), "powertrain.gears"),
        (
            good.replace("wheel_radius_m", "# wheel_radius_m"),
            "wheel_radius_m",
        ),
        (
            format!("{good}\n[traction]\nsource = \"force\"\n"),
            "[traction]",
        ),
        ("not toml at all".to_owned(), "bad.toml"),
    ] {
        assert_ne!(text, good, "the change for {words} did nothing");
        fs::write(&bad, text).unwrap();
        estimate(&bad, &log, &out)
            .code(1)
            .stderr(contains(words).and(contains("bad.toml")));
        assert!(!out.exists());
    }
}

fn without_gears(text: &str) -> String {
    let head = text.split("[[powertrain.gears]]").next().unwrap();
    format!("{head}gears = []\n")
}

#[test]
fn a_truck_that_never_moves_is_reported() {
    let log = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/data/css_truck_idle/truck_idle.log");
    if !log.exists() {
        eprintln!(
            "SKIPPED: no measured truck log beside the project ({})",
            log.display()
        );
        return;
    }
    let (folder, _, vehicle) = short_drive();
    let out = folder.path().join("run.csv");
    estimate(&vehicle, &log, &out)
        .code(1)
        .stderr(contains("never moved"));
    assert!(!out.exists());
}

#[test]
fn the_study_of_the_measured_bus_finds_its_drift() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    if !data.join("ztbus").exists() {
        eprintln!(
            "SKIPPED: no measured bus beside the project ({})",
            data.display()
        );
        return;
    }
    let folder = TempDir::new().unwrap();
    roadgrade()
        .args(["study", "ztbus", "--out"])
        .arg(folder.path())
        .arg("--data")
        .arg(&data)
        .assert()
        .success()
        .stdout(contains("1 outbound").and(contains("drift m/km")));
    let passes = fs::read_to_string(folder.path().join("ztbus_passes.csv")).unwrap();
    assert_eq!(passes.lines().count(), 7);
    // Passes agree with each other far better than either with terrain.
    for line in passes.lines().skip(1) {
        let others: f64 = line.split(',').nth(2).unwrap().parse().unwrap();
        assert!(others < 0.2, "{line}");
    }
}

#[test]
fn a_data_set_takes_runs_by_tile_and_day() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    simulate(at, MOTORWAY);
    let command = |arguments: &[&str]| {
        roadgrade()
            .current_dir(at)
            .args(["estimate", "--vehicle", "a_forward.vehicle.toml"])
            .args(arguments)
            .arg("a_forward.log")
            .assert()
    };
    command(&["--dataset", "runs", "--day", "2026-11-21"]).success();
    command(&["--out", "run.csv"]).success();
    let rows = run::read(&at.join("run.csv")).unwrap();
    let first = rows.iter().find(|row| row.latitude_deg.is_some()).unwrap();
    let tile =
        host_sim::files::data_set::tile(first.latitude_deg.unwrap(), first.longitude_deg.unwrap());
    let file = at.join(format!("runs/tile={tile}/day=2026-11-21/a_forward.parquet"));
    assert_eq!(run::read(&file).unwrap(), rows);
    let session = run::session(&file).unwrap().unwrap();
    assert!(session.ends_with(" 2026-11-21"), "{session}");

    // Again, and a log of the same name from another truck.
    command(&["--dataset", "runs", "--day", "2026-11-21"]).success();
    let vehicle = at.join("a_forward.vehicle.toml");
    let text = fs::read_to_string(&vehicle).unwrap();
    let other = text.replacen("name = \"", "name = \"another ", 1);
    assert_ne!(other, text);
    fs::write(&vehicle, other).unwrap();
    command(&["--dataset", "runs", "--day", "2026-11-21"])
        .code(1)
        .stderr(contains(
            "a_forward.parquet: already holds a run of another vehicle",
        ));
    assert_eq!(run::read(&file).unwrap(), rows);

    command(&["--dataset", "runs"])
        .code(2)
        .stderr(contains("--day"));
    command(&["--day", "2026-11-21"])
        .code(2)
        .stderr(contains("--out"));
    command(&["--dataset", "runs", "--day", "yesterday"])
        .code(2)
        .stderr(contains("expected YYYY-MM-DD"));
    command(&["--dataset", "runs", "--out", "b.csv", "--day", "2026-11-21"])
        .code(2)
        .stderr(contains("cannot be used with"));
}

#[test]
fn without_temporary_files_there_is_an_error_and_no_run() {
    let folder = TempDir::new().unwrap();
    simulate(
        folder.path(),
        "seed = 3\n[road]\nlength_m = 8000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n",
    );
    let out = folder.path().join("run.csv");
    roadgrade()
        .env("TMPDIR", folder.path().join("nowhere"))
        .args(["estimate", "--vehicle"])
        .arg(folder.path().join("a.vehicle.toml"))
        .arg("--out")
        .arg(&out)
        .arg(folder.path().join("a.log"))
        .assert()
        .code(1)
        .stderr(contains("nowhere"));
    assert!(!out.exists());
}
