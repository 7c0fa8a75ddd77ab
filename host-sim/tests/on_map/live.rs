//! `estimate --map` and `horizon`, from logs to files.

use crate::drives::{Ahead, Truth, assert_only_live_changes, json, rows, truth_at};
use host_sim::files::run::{RunRow, read};
use host_sim::map::{MapRow, write_map};
use std::path::Path;
use test_kit::command::{folder, roadgrade};

fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Simulates two drives of 12 km, packs the map of the first, and returns the folder.
fn prepared() -> tempfile::TempDir {
    let folder = folder();
    let scenario = "seed = 3\n[road]\nlength_m = 12000.0\n[[runs]]\nname = \"first\"\ntruck = \"A\"\n\
                    [[runs]]\nname = \"second\"\ntruck = \"B\"\n";
    std::fs::write(folder.path().join("s.toml"), scenario).expect("written");
    let run = |arguments: &[&str]| drop(roadgrade(folder.path(), arguments).success());
    run(&["simulate", "--scenario", "s.toml", "--out", "."]);
    run(&[
        "estimate",
        "--vehicle",
        "first.vehicle.toml",
        "--out",
        "first.csv",
        "first.log",
    ]);
    run(&[
        "fuse",
        "--out",
        "map.csv",
        "--road",
        "road.csv",
        "first.csv",
    ]);
    run(&["pack", "map.csv", "--out", "map.grade"]);
    folder
}

fn estimate(folder: &Path, map: &[&str], out: &str) -> Vec<RunRow> {
    let arguments = [
        "estimate",
        "--vehicle",
        "second.vehicle.toml",
        "--out",
        out,
        "second.log",
    ];
    roadgrade(folder, &[&arguments[..], map].concat()).success();
    read(&folder.join(out)).expect("a run")
}

fn live_error(rows: &[RunRow], truth: &[Truth]) -> f64 {
    let errors: Vec<f64> = rows
        .iter()
        .filter(|row| (1_000.0..11_500.0).contains(&row.distance_m))
        .filter_map(|row| Some(row.live_grade_percent - truth_at(truth, row.distance_m)?))
        .collect();
    root_mean_square(&errors)
}

#[test]
fn a_map_makes_the_live_grade_better_and_changes_nothing_else() {
    let folder = prepared();
    let truth: Vec<Truth> = rows(&folder.path().join("second.truth.csv"));
    let without = estimate(folder.path(), &[], "without.csv");
    let with = estimate(folder.path(), &["--map", "map.grade"], "with.parquet");
    let on_map = assert_only_live_changes(&with, &without);
    assert!(on_map > without.len() * 9 / 10);
    let [without, with] = [without, with].map(|rows| live_error(&rows, &truth));
    assert!(with < 0.7 * without, "{with} of {without} %");

    let json = json(
        folder.path(),
        &[
            "estimate",
            "--vehicle",
            "second.vehicle.toml",
            "--out",
            "j.csv",
            "--map",
            "map.grade",
            "second.log",
        ],
    );
    assert!(json["map"]["on_map_km"].as_f64().expect("a number") > 10.0);
    assert_eq!(json["map"]["left_out"], 0);
}

#[test]
fn the_page_of_a_drive_shows_its_map() {
    let folder = prepared();
    let page = |map: &[&str]| {
        let options = [map, &["--page", "page.html"]].concat();
        estimate(folder.path(), &options, "run.csv");
        std::fs::read_to_string(folder.path().join("page.html")).expect("a page")
    };
    assert!(!page(&[]).contains("With the map"));
    let page = page(&["--map", "map.grade"]);
    for words in [
        "With the map",
        "The map counted in",
        "live, with the map",
        "with_map_differences",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn a_wrong_map_is_left_out() {
    let folder = prepared();
    let truth: Vec<Truth> = rows(&folder.path().join("second.truth.csv"));
    let map: Vec<MapRow> = rows(&folder.path().join("map.csv"));
    let without = live_error(&estimate(folder.path(), &[], "without.csv"), &truth);
    let steeper = |row: &MapRow| MapRow {
        grade_percent: row.grade_percent + 1.0,
        ..*row
    };
    let shifted = |i: usize| MapRow {
        grade_percent: map[(i + 12).min(map.len() - 1)].grade_percent,
        ..map[i]
    };
    let wrong: [(&str, Vec<MapRow>); 2] = [
        ("steeper.csv", map.iter().map(steeper).collect()),
        ("shifted.csv", (0..map.len()).map(shifted).collect()),
    ];
    for (name, rows) in wrong {
        write_map(&folder.path().join(name), &rows).expect("written");
        roadgrade(folder.path(), &["pack", name, "--out", "wrong.grade"]).success();
        let with = estimate(folder.path(), &["--map", "wrong.grade"], "with.csv");
        let with = live_error(&with, &truth);
        assert!(with < 1.15 * without, "{name}: {with} of {without} %");
    }
}

#[test]
fn the_horizon_is_the_map_ahead() {
    let folder = prepared();
    roadgrade(
        folder.path(),
        &[
            "horizon",
            "--map",
            "map.grade",
            "--vehicle",
            "second.vehicle.toml",
            "--out",
            "ahead.csv",
            "second.log",
        ],
    )
    .success();
    let truth: Vec<Truth> = rows(&folder.path().join("second.truth.csv"));
    let ahead: Vec<Ahead> = rows(&folder.path().join("ahead.csv"));
    assert!(
        ahead
            .iter()
            .all(|row| row.branch == 0 && row.probability > 0.9)
    );
    let (mut errors, mut normalised) = (Vec::new(), Vec::new());
    for row in &ahead {
        assert!(row.ahead_m % 25.0 == 0.0 && row.ahead_m <= 2000.0);
        let there_m = row.distance_m + row.ahead_m;
        let known = row.grade_percent.zip(row.grade_sigma_percent);
        let Some(((grade, sigma), truth)) = known.zip(truth_at(&truth, there_m)) else {
            continue;
        };
        errors.push(grade - truth);
        normalised.push((grade - truth) / sigma);
    }
    assert!(errors.len() > 20_000);
    assert!(
        root_mean_square(&errors) < 0.1,
        "{}",
        root_mean_square(&errors)
    );
    assert!(
        root_mean_square(&normalised) < 1.5,
        "{}",
        root_mean_square(&normalised)
    );
}

#[test]
fn what_is_no_packed_map_is_named() {
    let folder = folder();
    std::fs::write(folder.path().join("map.grade"), "distance_m\n").expect("written");
    let vehicle = "[vehicle]\n";
    std::fs::write(folder.path().join("v.toml"), vehicle).expect("written");
    for command in ["estimate", "horizon"] {
        let arguments = [
            command,
            "--vehicle",
            "v.toml",
            "--map",
            "map.grade",
            "--out",
            "o.csv",
            "a.log",
        ];
        roadgrade(folder.path(), &arguments).code(1);
        assert!(!folder.path().join("o.csv").exists());
    }
}
