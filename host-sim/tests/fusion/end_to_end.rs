//! `roadgrade fuse` at the command line.

use assert_cmd::assert::Assert;
use host_sim::files::run::{self, RunRow};
use host_sim::map::read_map;
use predicates::prelude::*;
use predicates::str::contains;
use std::fmt::Write as _;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::{folder, roadgrade};
use test_kit::roads::{hill_percent, hills, moved, reversed, road, run};

fn fuse(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(
        folder,
        &[&["fuse", "--out", "map.csv"][..], arguments].concat(),
    )
}

fn save(folder: &TempDir, name: &str, rows: &[RunRow]) {
    run::write(&folder.path().join(name), rows).expect("written");
}

fn save_road(folder: &TempDir, name: &str, spots: &[test_kit::roads::Spot]) {
    let mut text = String::from("distance_m,latitude_deg,longitude_deg\n");
    for row in road(spots) {
        let _ = writeln!(
            text,
            "{},{},{}",
            row.distance_m, row.latitude_deg, row.longitude_deg
        );
    }
    std::fs::write(folder.path().join(name), text).expect("written");
}

#[test]
fn runs_become_a_map_and_a_map_is_a_road() {
    let folder = folder();
    let spots = hills();
    save(&folder, "a.csv", &run(&spots));
    save(&folder, "b.csv", &run(&spots[400..]));
    fuse(folder.path(), &["a.csv", "b.csv"])
        .success()
        .stdout("")
        .stderr(contains("b.csv: 2001 cells: 2001 matched, 0 off the road"));
    let map = read_map(&folder.path().join("map.csv")).expect("a map");
    for row in &map {
        assert!((row.grade_percent - hill_percent(row.distance_m)).abs() < 0.01);
        if (row.distance_m - 1000.0).abs() > 1.0 {
            let runs = if row.distance_m > 1000.0 { 2 } else { 1 };
            assert_eq!(row.runs, runs, "{row:?}");
        }
    }

    let first = std::fs::read(folder.path().join("map.csv")).expect("bytes");
    fuse(folder.path(), &["a.csv", "b.csv"]).success();
    assert_eq!(
        first,
        std::fs::read(folder.path().join("map.csv")).expect("bytes")
    );

    std::fs::rename(
        folder.path().join("map.csv"),
        folder.path().join("road.csv"),
    )
    .expect("moved");
    fuse(folder.path(), &["--road", "road.csv", "b.csv"]).success();
    let again = read_map(&folder.path().join("map.csv")).expect("a map");
    assert!((again[0].distance_m - 1000.0).abs() < 5.1, "{:?}", again[0]);
    assert!(again.len() > 1990);
}

#[test]
fn a_run_that_matches_nowhere_is_a_warning_beside_others() {
    let folder = folder();
    let spots = hills();
    save(&folder, "forth.csv", &run(&spots));
    save(&folder, "back.csv", &run(&reversed(&spots)));
    save(&folder, "away.csv", &run(&moved(&spots, 900e3, 0.0)));
    fuse(folder.path(), &["forth.csv", "back.csv", "away.csv"])
        .success()
        .stderr(
            contains("back.csv: 2401 cells: 0 matched")
                .and(contains("warning: opposite direction"))
                .and(contains(
                    "away.csv: 2401 cells: 0 matched, 2401 off the road",
                ))
                .and(contains("warning: 2 of 3 runs cover no cell")),
        );
    assert!(folder.path().join("map.csv").exists());
}

#[test]
fn no_run_on_the_road_is_an_error() {
    let folder = folder();
    let spots = hills();
    save_road(&folder, "road.csv", &spots);
    save(&folder, "back.csv", &run(&reversed(&spots)));
    fuse(folder.path(), &["--road", "road.csv", "back.csv"])
        .code(1)
        .stderr(contains("back.csv").and(contains("expected runs over the road")));

    let mut blind = run(&spots);
    for row in &mut blind {
        row.latitude_deg = None;
        row.longitude_deg = None;
    }
    save(&folder, "blind.csv", &blind);
    fuse(folder.path(), &["blind.csv"])
        .code(1)
        .stderr(contains("blind.csv: no positions"));
    assert!(!folder.path().join("map.csv").exists());

    // The next run with a track defines the road.
    save(&folder, "forth.csv", &run(&spots));
    fuse(folder.path(), &["blind.csv", "forth.csv"])
        .success()
        .stderr(contains(
            "warning: blind.csv: no positions to take the road from",
        ));
}

/// Returns a valid RUN.csv as text.
fn run_text() -> String {
    let folder = folder();
    save(&folder, "run.csv", &run(&hills()[..20]));
    std::fs::read_to_string(folder.path().join("run.csv")).expect("text")
}

fn with_line(number: usize, change: impl Fn(&mut Vec<String>)) -> String {
    let text = run_text();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut fields: Vec<String> = lines[number - 1].split(',').map(str::to_owned).collect();
    change(&mut fields);
    lines[number - 1] = fields.join(",");
    lines.join("\n")
}

fn set_field(line: usize, column: usize, value: &str) -> String {
    with_line(line, |fields| fields[column] = value.into())
}

#[test]
fn broken_runs_are_reported_with_file_and_line() {
    let set = |column: usize, value: &str| set_field(4, column, value);
    let cases = [
        (
            "text in a number",
            set(6, "steep"),
            "bad.csv:4: grade_percent: ",
        ),
        (
            "NaN",
            set(6, "NaN"),
            "bad.csv:4: grade_percent is NaN; expected a finite number",
        ),
        (
            "infinite",
            set(5, "inf"),
            "bad.csv:4: altitude_sigma_m is inf",
        ),
        (
            "no weight",
            set(7, "0"),
            "bad.csv:4: grade_sigma_percent is 0; expected",
        ),
        (
            "negative sigma",
            set(7, "-0.1"),
            "bad.csv:4: grade_sigma_percent is -0.1",
        ),
        (
            "incomplete position",
            set(2, ""),
            "bad.csv:4: incomplete position",
        ),
        (
            "not on Earth",
            set(2, "147.4"),
            "bad.csv:4: latitude_deg is 147.4",
        ),
        (
            "distance backwards",
            set(1, "1.0"),
            "bad.csv:4: distance_m is 1 after 2.5",
        ),
        (
            "time backwards",
            set(0, "-5"),
            "bad.csv:4: time_s is -5 after",
        ),
        (
            "valid",
            set(15, "2"),
            "bad.csv:4: valid is 2; expected 0 or 1",
        ),
        (
            "a field less",
            with_line(4, |fields| drop(fields.pop())),
            "bad.csv:4: 22 fields under a header of 23",
        ),
        (
            "missing column",
            run_text().replace("grade_percent,grade_sigma", "slope,grade_sigma"),
            "bad.csv:1: unknown column `slope`",
        ),
        (
            "missing optional column",
            run_text()
                .lines()
                .map(|line| {
                    let mut fields: Vec<&str> = line.split(',').collect();
                    fields.remove(2);
                    fields.join(",") + "\n"
                })
                .collect(),
            "bad.csv:1: no column `latitude_deg`",
        ),
        ("empty", String::new(), "bad.csv: no rows"),
        (
            "header only",
            run_text().lines().next().expect("a header").to_owned(),
            "bad.csv: no rows",
        ),
    ];
    for (what, text, message) in cases {
        let folder = folder();
        save(&folder, "good.csv", &run(&hills()));
        std::fs::write(folder.path().join("bad.csv"), text).expect("written");
        for order in [["good.csv", "bad.csv"], ["bad.csv", "good.csv"]] {
            let assert = fuse(folder.path(), &order).code(1);
            let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
            assert!(stderr.contains(message), "{what}: {stderr}");
            assert!(!folder.path().join("map.csv").exists(), "{what}");
        }
    }
}

#[test]
fn binary_and_absent_runs_are_reported() {
    let folder = folder();
    let mut bytes = set_field(20, 6, "?").into_bytes();
    let at = bytes
        .iter()
        .position(|&byte| byte == b'?')
        .expect("the mark");
    bytes[at] = 0xff;
    std::fs::write(folder.path().join("bad.csv"), bytes).expect("written");
    fuse(folder.path(), &["bad.csv"])
        .code(1)
        .stderr(contains("bad.csv:20: not text"));
    fuse(folder.path(), &["absent.csv"])
        .code(1)
        .stderr(contains("absent.csv: "));
    fuse(folder.path(), &["."])
        .code(1)
        .stderr(contains("./bad.csv:20: not text"));
    fuse(folder.path(), &[]).code(2);
    assert!(!folder.path().join("map.csv").exists());
}

#[test]
fn broken_roads_are_reported_with_file_and_line() {
    let folder = folder();
    save(&folder, "run.csv", &run(&hills()));
    let header = "distance_m,latitude_deg,longitude_deg\n";
    let cases = [
        (
            format!("{header}0,47.4,8.5\n"),
            "road.csv: fewer than two points",
        ),
        (
            format!("{header}0,47.4,8.5\n10,47.4,x\n"),
            "road.csv:3: longitude_deg: ",
        ),
        (
            format!("{header}0,47.4,8.5\n0,47.4001,8.5\n"),
            "road.csv:3: distance_m is 0 after 0",
        ),
        (
            format!("{header}0,47.4,8.5\n10,47.4,NaN\n"),
            "road.csv:3: longitude_deg is NaN",
        ),
        (
            format!("{header}0,47.4,8.5\n10,47.5,8.5\n"),
            "road.csv:3: 11118",
        ),
        (
            "distance_m,latitude_deg\n0,47.4\n".into(),
            "road.csv:1: no column `longitude_deg`",
        ),
        (String::new(), "road.csv: no rows"),
    ];
    for (text, message) in cases {
        std::fs::write(folder.path().join("road.csv"), &text).expect("written");
        fuse(folder.path(), &["--road", "road.csv", "run.csv"])
            .code(1)
            .stderr(contains(message));
        assert!(!folder.path().join("map.csv").exists(), "{text}");
    }
}
