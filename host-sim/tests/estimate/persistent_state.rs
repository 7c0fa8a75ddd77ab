//! Two simulated drives of a truck, one after the other: the gain of the second from the persistent
//! state of the first, and the file of `roadgrade estimate --kept`.

use estimator_core::{Estimator, PersistentState, Tuning};
use host_sim::files::run::RunRow;
use host_sim::numeric::series::linear;
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::simulator::random::{Purpose, normal, stream};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{SimulatedRun, simulate};
use predicates::prelude::*;
use predicates::str::contains;
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::program;

/// Factors of the true parameters over the assumed ones, as in a fleet.
#[derive(Clone, Copy)]
struct Factors {
    mass: f64,
    drag: f64,
    rolling: f64,
    torque: f64,
}

/// Simulates a drive with cold tyres. The seed determines the road and the wind.
fn driven(seed: u64, truck: &str, length_m: f64, factors: Factors) -> SimulatedRun {
    let Factors {
        mass,
        drag,
        rolling,
        torque,
    } = factors;
    let wind_deg = seed * 77 % 360;
    let text = format!(
        "seed = {seed}\n[road]\nlength_m = {length_m}\n[rates]\nfast_ms = 100.0\n\
         [tyres]\ncold_amount = 0.3\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = {wind_deg}\ngust_sigma_mps = 0.3\ngust_time_s = 120.0\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n\
         errors = {{ mass_factor = {mass}, drag_factor = {drag}, rolling_factor = {rolling}, \
         torque_factor = {torque} }}\n"
    );
    let scenario = Scenario::parse(&text, Path::new("a drive")).expect("a scenario");
    simulate(&scenario, 0).expect("driven")
}

fn estimated(drive: &SimulatedRun, last: Option<&PersistentState>) -> SmoothedRun {
    let (vehicle, tuning) = (drive.vehicle.model.clone(), Tuning::default());
    let estimator = match last {
        Some(kept) => Estimator::<f32>::restore(vehicle, tuning, kept).expect("of this truck"),
        None => Estimator::new(vehicle, tuning).expect("a truck"),
    };
    let mut recorder = Recorder::from(estimator);
    for frame in &drive.frames {
        recorder.on_frame(frame);
    }
    recorder.finish().unwrap()
}

/// A grade and its sigma, %.
type Grade = fn(&RunRow) -> (f64, f64);
/// RMSE, %, and mean normalised squared error.
type Score = [f64; 2];

/// Returns the scores over the first 5 km without the first 500 m: live, lagged and smoothed.
fn first_km(drive: &SimulatedRun, rows: &[RunRow]) -> [Score; 3] {
    let truth: Vec<(f64, f64)> = drive
        .truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    let estimates: [Grade; 3] = [
        |row| (row.live_grade_percent, row.live_grade_sigma_percent),
        |row| (row.lagged_grade_percent, row.lagged_grade_sigma_percent),
        |row| (row.grade_percent, row.grade_sigma_percent),
    ];
    estimates.map(|estimate| {
        let (mut count, mut squares, mut normalised) = (0.0, 0.0, 0.0);
        let first = |row: &&RunRow| (500.0..5_000.0).contains(&row.distance_m);
        for row in rows.iter().filter(first) {
            let (grade, sigma) = estimate(row);
            let error = grade - linear(&truth, row.time_s).expect("known all along");
            count += 1.0;
            squares += error * error;
            normalised += error * error / (sigma * sigma);
        }
        [(squares / count).sqrt(), normalised / count]
    })
}

/// Returns the mean scores of the second drives, without and with the persistent state of the
/// first. The mass of each truck is `load` times that of its first drive.
fn second_drives(truck: &str, load: f64) -> [[Score; 3]; 2] {
    const TRUCKS: u64 = 16;
    let scores: Vec<[[Score; 3]; 2]> = (0..TRUCKS)
        .into_par_iter()
        .map(|number| {
            let mut rng = stream(2_000 + number, 0, Purpose::Parameters);
            let mut factor = |sigma: f64| (1.0 + sigma * normal(&mut rng)).clamp(0.7, 1.3);
            let factors = Factors {
                mass: factor(0.1),
                drag: factor(0.1),
                rolling: factor(0.1),
                torque: factor(0.04),
            };
            let mass = load * factors.mass;
            let first = driven(3_000 + number, truck, 20_000.0, factors);
            let second = driven(4_000 + number, truck, 6_500.0, Factors { mass, ..factors });
            let kept = estimated(&first, None)
                .persistent_state
                .expect("20 km are enough");
            let kept = PersistentState::from_bytes(&kept.to_bytes()).expect("undamaged");
            [None, Some(&kept)].map(|kept| first_km(&second, &estimated(&second, kept).rows))
        })
        .collect();
    let mean = |score: &dyn Fn(&[[Score; 3]; 2]) -> f64| {
        scores.iter().map(score).sum::<f64>() / TRUCKS as f64
    };
    [0, 1].map(|kept| [0, 1, 2].map(|which| [0, 1].map(|i| mean(&|s| s[kept][which][i]))))
}

#[test]
fn the_same_load_is_estimated_better_from_the_first_km_on() {
    for truck in ["A", "B"] {
        let [without, with] = second_drives(truck, 1.0);
        println!("{truck} {without:.3?} {with:.3?}");
        for (k, (without, with)) in without.iter().zip(&with).enumerate() {
            // The smoothed estimate gains less: it also uses the rest of the drive.
            let gain = if k < 2 { 1.0 } else { 1.04 };
            assert!(with[0] < gain * without[0], "{truck}: {without:?} {with:?}");
            assert!(with[1] <= 1.5, "{truck}: {with:?}");
        }
    }
}

#[test]
fn a_load_that_changed_unnoticed_is_allowed_for() {
    for truck in ["A", "B"] {
        let [without, with] = second_drives(truck, 1.3);
        println!("{truck} {without:.3?} {with:.3?}");
        for (without, with) in without.iter().zip(&with) {
            assert!(with[1] <= 1.5, "{truck}: {without:?} {with:?}");
            assert!(with[0] < 1.15 * without[0], "{truck}: {without:?} {with:?}");
        }
        // Unloaded: an error of scale of 0.43, which is rare after a drive with another load.
        let [without, with] = second_drives(truck, 0.7);
        println!("{truck} {without:.3?} {with:.3?}");
        for (without, with) in without.iter().zip(&with) {
            assert!(with[1] <= 2.0, "{truck}: {without:?} {with:?}");
            assert!(with[0] < 1.2 * without[0], "{truck}: {without:?} {with:?}");
        }
    }
}

/// Simulates two drives of a truck A whose mass is wrong by 20 %, one of B, and a short one.
fn drives() -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut scenario =
        "seed = 11\n[road]\nlength_m = 12000.0\n[rates]\nfast_ms = 100.0\n".to_owned();
    for (name, truck, direction, length_m) in [
        ("one", "A", "forward", 12_000),
        ("two", "A", "backward", 12_000),
        ("other", "B", "forward", 12_000),
        ("short", "A", "forward", 3_000),
    ] {
        scenario += &format!(
            "[[runs]]\nname = \"{name}\"\ntruck = \"{truck}\"\ndirection = \"{direction}\"\n\
             length_m = {length_m}\nerrors = {{ mass_factor = 1.2 }}\n"
        );
    }
    let file = folder.path().join("scenario.toml");
    fs::write(&file, scenario).unwrap();
    program()
        .args(["simulate", "--scenario"])
        .arg(&file)
        .arg("--out")
        .arg(folder.path())
        .assert()
        .success();
    folder
}

/// Runs `estimate` on a drive. The result goes to NAME.csv or, with `kept`, to NAME.kept.csv.
fn estimate(
    folder: &Path,
    name: &str,
    kept: Option<&Path>,
) -> (assert_cmd::assert::Assert, PathBuf) {
    let file = |end: &str| folder.join(format!("{name}.{end}"));
    let out = file(if kept.is_some() { "kept.csv" } else { "csv" });
    let mut command = program();
    command
        .arg("estimate")
        .arg("--vehicle")
        .arg(file("vehicle.toml"));
    if let Some(kept) = kept {
        command.arg("--kept").arg(kept);
    }
    (
        command.arg("--out").arg(&out).arg(file("log")).assert(),
        out,
    )
}

#[test]
fn the_file_goes_from_drive_to_drive() {
    let drives = drives();
    let folder = drives.path();
    let memory = folder.join("truck.kept");

    // No file yet: the result is that without the option, and a file is written.
    let (plain, plain_out) = estimate(folder, "one", None);
    plain.success();
    let (first, first_out) = estimate(folder, "one", Some(&memory));
    first.success().stderr(
        contains("stored the persistent state for the next drive").and(contains("truck.kept")),
    );
    assert_eq!(fs::read(plain_out).unwrap(), fs::read(first_out).unwrap());
    let left = fs::read(&memory).unwrap();
    assert_eq!(left.len(), PersistentState::LEN);
    let scale = PersistentState::from_bytes(&left)
        .unwrap()
        .slow_states()
        .scale
        .mean;
    assert!((scale - (1.0 / 1.2 - 1.0)).abs() < 0.08, "{scale}");

    // The next drive begins with the file and writes another. The same bytes give the same result.
    let (plain, plain_out) = estimate(folder, "two", None);
    plain.success();
    let (second, second_out) = estimate(folder, "two", Some(&memory));
    second.success();
    let second_left = fs::read(&memory).unwrap();
    assert_ne!(second_left, left);
    let rows = |path: &Path| host_sim::files::run::read(path).unwrap();
    let (without, with) = (rows(&plain_out), rows(&second_out));
    assert_eq!(without.len(), with.len());
    // Live, lagged and smoothed alike: the smoother, too, begins with the persistent state.
    let grades: [fn(&RunRow) -> f64; 3] = [
        |row| row.live_grade_percent,
        |row| row.lagged_grade_percent,
        |row| row.grade_percent,
    ];
    for grade in grades {
        assert!((grade(&without[0]) - grade(&with[0])).abs() > 1e-4);
    }
    fs::write(&memory, &left).unwrap();
    estimate(folder, "two", Some(&memory)).0.success();
    assert_eq!(fs::read(&memory).unwrap(), second_left);
    assert_eq!(rows(&second_out), with);

    // A short drive leaves the file unchanged.
    let (short, short_out) = estimate(folder, "short", Some(&memory));
    short.success().stderr(contains("is unchanged"));
    assert!(short_out.exists());
    assert_eq!(fs::read(&memory).unwrap(), second_left);
}

#[test]
fn an_unusable_file_is_refused_by_name_and_nothing_changes() {
    let drives = drives();
    let folder = drives.path();
    let memory = folder.join("truck.kept");
    estimate(folder, "one", Some(&memory)).0.success();
    let left = fs::read(&memory).unwrap();
    fs::remove_file(folder.join("one.kept.csv")).unwrap();

    let refused = |name: &str, bytes: &[u8], reason: &str| {
        fs::write(&memory, bytes).unwrap();
        let (run, out) = estimate(folder, name, Some(&memory));
        run.code(1)
            .stderr(contains("truck.kept").and(contains(reason)));
        assert!(!out.exists(), "{reason}");
        assert_eq!(fs::read(&memory).unwrap(), bytes);
    };
    let mut damaged = left.clone();
    damaged[30] ^= 4;
    refused("two", &damaged, "damaged");
    refused("two", &left[..20], "20 bytes: expected 108");
    refused("two", b"", "0 bytes: expected 108");
    refused("two", b"time_s,distance_m\n", "not a persistent state");
    let mut later = left.clone();
    later[4] = 6;
    refused("two", &later, "version 6: expected 5");
    refused("other", &left, "another vehicle");

    let vehicle = folder.join("two.vehicle.toml");
    let text = fs::read_to_string(&vehicle).unwrap();
    fs::write(
        &vehicle,
        text.replace("drag_area_m2 = 6.0", "drag_area_m2 = 6.1"),
    )
    .unwrap();
    refused("two", &left, "other parameters");
    fs::write(&vehicle, text).unwrap();
    fs::write(&memory, &left).unwrap();
    estimate(folder, "two", Some(&memory)).0.success();

    // A folder in its place.
    let (run, _) = estimate(folder, "one", Some(folder));
    run.code(1).stderr(contains("is a folder"));
    assert!(!folder.join("one.kept.csv").exists());
}

#[test]
fn a_log_that_cannot_be_estimated_leaves_the_file() {
    let drives = drives();
    let folder = drives.path();
    let memory = folder.join("truck.kept");
    fs::write(folder.join("one.log"), "(0.0) can0 zzz#\n").unwrap();
    let (run, out) = estimate(folder, "one", Some(&memory));
    run.code(1);
    assert!(!out.exists() && !memory.exists());
}
