//! `estimate --memory`: roads that the vehicle has learned itself.

use crate::drives::{
    Errors, Truth, assert_only_live_changes, estimate, json, measured_road, rows, truth_at,
};
use host_sim::files::run::{RunRow, read};
use host_sim::map::MapRow;
use std::path::Path;
use test_kit::command::{folder, roadgrade};

/// Simulates drives of 12 km by one truck with wrong parameters.
fn simulated(names: &[&str]) -> tempfile::TempDir {
    let folder = folder();
    let mut scenario =
        "seed = 3\n[road]\nlength_m = 12000.0\n[errors]\nmass_factor = 1.1\n".to_owned();
    for name in names {
        scenario += &format!("[[runs]]\nname = \"{name}\"\ntruck = \"A\"\n");
    }
    std::fs::write(folder.path().join("s.toml"), scenario).expect("written");
    roadgrade(
        folder.path(),
        &["simulate", "--scenario", "s.toml", "--out", "."],
    )
    .success();
    folder
}

fn known(rows: &[RunRow]) -> usize {
    let known = rows.iter().filter(|row| row.map_grade_percent.is_some());
    known.count()
}

#[test]
fn the_second_time_the_live_grade_is_better_and_nothing_else_changes() {
    let folder = simulated(&["first", "second"]);
    let path = folder.path();
    let memory = ["--memory", "roads.memory", "--memory-bytes", "262144"];
    assert_eq!(known(&estimate(path, "first", &memory)), 0);
    let size = path.join("roads.memory").metadata().expect("a file").len();
    assert_eq!(size, 262_144);
    let without = estimate(path, "second", &[]);
    let with = estimate(path, "second", &memory[..2]);
    let on_map = assert_only_live_changes(&with, &without);
    assert!(on_map > with.len() * 95 / 100);
    let error = |run| {
        let mut errors = Errors::default();
        errors.add_drive(path, "second", run);
        errors.rms()
    };
    assert!(error(&with) < 0.75 * error(&without));

    // The same drive with the same memory gives the same: each of these files is written once.
    let json = json(
        path,
        &[
            "estimate",
            "--vehicle",
            "second.vehicle.toml",
            "--out",
            "j.csv",
            "--memory",
            "roads.memory",
            "second.log",
        ],
    );
    assert!(json["memory"]["known_km"].as_f64().expect("a number") > 11.0);
    assert_eq!(json["memory"]["left_out"], 0);
}

#[test]
fn a_map_and_the_memory_count_together() {
    let folder = simulated(&["first", "second", "other"]);
    let path = folder.path();
    estimate(path, "other", &[]);
    let run = |arguments: &[&str]| drop(roadgrade(path, arguments).success());
    run(&[
        "fuse",
        "--out",
        "map.csv",
        "--road",
        "road.csv",
        "other.csv",
    ]);
    run(&["pack", "map.csv", "--out", "map.grade"]);
    estimate(path, "first", &["--memory", "roads.memory"]);
    std::fs::copy(path.join("roads.memory"), path.join("copy.memory")).expect("copied");
    let map = estimate(path, "second", &["--map", "map.grade"]);
    let memory = estimate(path, "second", &["--memory", "copy.memory"]);
    let both = estimate(
        path,
        "second",
        &["--map", "map.grade", "--memory", "roads.memory"],
    );
    let mean = |run: &[RunRow]| {
        let sum: f64 = run.iter().map(|row| row.live_grade_sigma_percent).sum();
        sum / run.len() as f64
    };
    assert!(mean(&both) < 0.95 * mean(&map).min(mean(&memory)));
    let of_road = both.iter().filter_map(|row| row.map_grade_sigma_percent);
    let of_map = map.iter().filter_map(|row| row.map_grade_sigma_percent);
    assert!(of_road.sum::<f64>() < of_map.sum::<f64>());
}

#[test]
fn a_memory_leaves_the_truck_as_a_run() {
    let folder = simulated(&["first"]);
    let path = folder.path();
    let first = estimate(path, "first", &["--memory", "roads.memory"]);
    roadgrade(path, &["export", "roads.memory", "--out", "learned.csv"]).success();
    let learned = read(&path.join("learned.csv")).expect("a run");
    assert!(learned.len() + 20 > first.len());
    roadgrade(
        path,
        &[
            "fuse",
            "--out",
            "map.csv",
            "--road",
            "road.csv",
            "learned.csv",
        ],
    )
    .success();
    let map: Vec<MapRow> = rows(&path.join("map.csv"));
    let truth: Vec<Truth> = rows(&path.join("first.truth.csv"));
    assert!(map.len() > 4_600);
    for row in &map[200..4_500] {
        let error = row.grade_percent - truth_at(&truth, row.distance_m).expect("truth");
        assert!(error.abs() < 0.6, "{error} % at {} m", row.distance_m);
    }
    roadgrade(path, &["export", "roads.memory", "--out", "learned.kml"]).code(2);
}

#[test]
fn what_is_no_memory_is_named_and_not_changed() {
    let folder = simulated(&["first"]);
    let path = folder.path();
    std::fs::write(path.join("table.csv"), "distance_m\n".repeat(40_960)).expect("written");
    std::fs::write(path.join("other.bin"), vec![7; 40_960]).expect("written");
    std::fs::write(path.join("short.bin"), vec![0xff; 4_097]).expect("written");
    let estimate = |options: &[&str]| {
        let arguments = [
            "estimate",
            "--vehicle",
            "first.vehicle.toml",
            "--out",
            "o.csv",
            "first.log",
        ];
        roadgrade(path, &[&arguments[..], options].concat())
    };
    for name in ["table.csv", "other.bin", "short.bin"] {
        let before = std::fs::read(path.join(name)).expect("a file");
        estimate(&["--memory", name]).code(1);
        assert_eq!(std::fs::read(path.join(name)).expect("a file"), before);
        assert!(!path.join("o.csv").exists());
    }
    for bytes in ["0", "4096", "40961", "33554432", "many"] {
        estimate(&["--memory", "m", "--memory-bytes", bytes]).code(2);
    }
    estimate(&["--memory-bytes", "65536"]).code(2);
    // A memory has one size.
    estimate(&["--memory", "roads.memory", "--memory-bytes", "65536"]).success();
    estimate(&["--memory", "roads.memory", "--memory-bytes", "131072"]).code(1);
    // A drive that cannot be estimated leaves no memory.
    std::fs::write(path.join("empty.log"), "").expect("written");
    let arguments = [
        "estimate",
        "--vehicle",
        "first.vehicle.toml",
        "--out",
        "p.csv",
    ];
    let arguments = [&arguments[..], &["--memory", "new.memory", "empty.log"]].concat();
    roadgrade(path, &arguments).code(1);
    assert!(!path.join("new.memory").exists());
}

/// Drives over the profile of a measured road by one truck, five times, with a memory and wrong
/// parameters. Returns the errors of each drive.
fn five_drives(road: &Path, truck: &str, seeds: &[u32]) -> [Errors; 5] {
    let mut errors = [Errors::default(); 5];
    for seed in seeds {
        let folder = folder();
        std::fs::copy(road, folder.path().join("road.csv")).expect("copied");
        let mut scenario = format!("seed = {seed}\n[road]\nfile = \"road.csv\"\n");
        for drive in 0..5 {
            scenario += &format!(
                "[[runs]]\nname = \"{drive}\"\ntruck = \"{truck}\"\nlength_m = 40000.0\n\
                 wind = {{ speed_mps = 2.0, from_deg = {}.0 }}\n[runs.errors]\nmass_factor = 1.1\n\
                 drag_factor = 0.9\nrolling_factor = 1.1\ntorque_factor = 0.96\n",
                72 * drive
            );
        }
        std::fs::write(folder.path().join("s.toml"), scenario).expect("written");
        roadgrade(
            folder.path(),
            &["simulate", "--scenario", "s.toml", "--out", "."],
        )
        .success();
        for (drive, errors) in errors.iter_mut().enumerate() {
            let name = drive.to_string();
            let run = estimate(folder.path(), &name, &["--memory", "roads.memory"]);
            errors.add_drive(folder.path(), &name, &run);
        }
    }
    errors
}

#[test]
fn the_fifth_time_a_road_is_nearly_as_good_as_a_map() {
    let Some(road) = measured_road() else {
        return;
    };
    for (truck, second, fifth) in [("A", 0.07, 0.055), ("B", 0.08, 0.06)] {
        let errors = five_drives(&road, truck, &[7, 8]);
        for drive in &errors {
            eprintln!("{truck}: {:.4} % {:.2}", drive.rms(), drive.normalised());
        }
        assert!(errors[1].rms() <= second, "{truck}: {} %", errors[1].rms());
        assert!(errors[4].rms() <= fifth, "{truck}: {} %", errors[4].rms());
        for drive in &errors[1..] {
            let normalised = drive.normalised();
            assert!((0.25..1.5).contains(&normalised), "{truck}: {normalised}");
        }
    }
}
