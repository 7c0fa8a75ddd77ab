//! `roadgrade fuse --store` and `--session`: a map that grows run by run.

use assert_cmd::assert::Assert;
use host_sim::files::run::{self, RunRow};
use host_sim::map::{Network, RoadLine, read_map, read_store};
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use test_kit::command::roadgrade;
use test_kit::roads::{hills, moved, reversed, run};

fn fuse(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(
        folder,
        &[&["fuse", "--out", "map.csv"][..], arguments].concat(),
    )
}

/// Returns a run over the hills whose grade, position and sigma depend on its number.
fn wavy(number: usize) -> Vec<RunRow> {
    let mut rows = run(&test_kit::roads::with_position_noise(
        &hills(),
        1.5,
        80.0,
        number as u64,
    ));
    for row in &mut rows {
        row.grade_percent += 0.05 * (row.distance_m / (70.0 + 9.0 * number as f64)).sin();
        row.grade_sigma_percent = 0.05 + 0.01 * number as f64;
    }
    rows
}

/// Returns a folder with the runs 0.csv to 5.csv.
fn six_runs() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for number in 0..6 {
        let path = folder.path().join(format!("{number}.csv"));
        run::write(&path, &wavy(number)).expect("written");
    }
    folder
}

fn text(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).expect(name)
}

/// Returns the number of lines of a store outside its list of runs.
fn lines(folder: &TempDir, name: &str) -> usize {
    let text = text(folder, name);
    text.lines().filter(|line| !is_run(line)).count()
}

fn is_run(line: &str) -> bool {
    line.starts_with("# run ")
}

#[test]
fn a_stored_map_grows_into_the_map_of_all_runs() {
    let folder = six_runs();
    let at = folder.path();
    let all = ["0.csv", "1.csv", "--session", "x=2.csv,3.csv,4.csv"];
    fuse(at, &[&all[..], &["--session", "y=5.csv"]].concat()).success();
    let at_once = text(&folder, "map.csv");

    let store = ["--store", "sums.csv"];
    let step = |arguments: &[&str]| fuse(at, &[&store[..], arguments].concat()).success();
    step(&["0.csv", "--session", "x=2.csv"]);
    step(&["--session", "x=3.csv", "--session", "y=5.csv"]);
    step(&["1.csv", "--session", "x=4.csv"]).stderr(contains("runs of session x differ by"));
    let grown = text(&folder, "map.csv");
    assert_eq!(at_once, grown);

    // Without runs: the map of the store. The store does not change.
    let sums = text(&folder, "sums.csv");
    fs::remove_file(at.join("map.csv")).expect("removed");
    step(&[]);
    assert_eq!(text(&folder, "map.csv"), grown);
    assert_eq!(text(&folder, "sums.csv"), sums);
    // In another order the map is equal up to the rounding of sums.
    let other = ["--store", "other.csv", "--road", "map.csv"];
    fuse(
        at,
        &[&other[..], &["--session", "y=5.csv", "1.csv"]].concat(),
    )
    .success();
    fuse(at, &["--store", "other.csv", "--session", "x=4.csv,2.csv"]).success();
    fuse(
        at,
        &["--store", "other.csv", "0.csv", "--session", "x=3.csv"],
    )
    .success();
    let a = read_map(&at.join("map.csv")).expect("a map");
    fs::write(at.join("first.csv"), &grown).expect("written");
    let b = read_map(&at.join("first.csv")).expect("a map");
    // The map's coordinates are rounded to a centimetre, which shifts the runs on it.
    for (a, b) in a.iter().zip(&b) {
        assert!(
            (a.grade_percent - b.grade_percent).abs() < 2e-3,
            "{a:?} {b:?}"
        );
        assert!((a.grade_sigma_percent - b.grade_sigma_percent).abs() < 1e-4);
    }
}

#[test]
fn the_order_of_additions_does_not_matter() {
    let folder = six_runs();
    let at = folder.path();
    // Both stores begin with the same road.
    for (store, order) in [("a.csv", ["1", "2", "3"]), ("b.csv", ["3", "1", "2"])] {
        fuse(at, &["--store", store, "0.csv"]).success();
        for number in order {
            let run = format!("{number}.csv");
            let session = format!("x={run}");
            let arguments = match number {
                "1" => vec![run.as_str()],
                _ => vec!["--session", session.as_str()],
            };
            fuse(at, &[&["--store", store][..], &arguments].concat()).success();
        }
    }
    let [a, b] = ["a.csv", "b.csv"].map(|name| read_store(&at.join(name)).expect(name));
    let (road_a, road_b) = (line(a.road().expect("one")), line(b.road().expect("one")));
    let (a, b) = (a.resume(&road_a).fused(), b.resume(&road_b).fused());
    assert!(a.rows().len() > 2300);
    for (a, b) in a.rows().iter().zip(&b.rows()) {
        assert!((a.grade_percent - b.grade_percent).abs() <= 1e-12);
        assert!((a.grade_sigma_percent / b.grade_sigma_percent - 1.0).abs() <= 1e-12);
        assert_eq!(a.runs, b.runs);
    }
}

fn line(points: &[host_sim::map::RoadPoint]) -> Network {
    RoadLine::new(points.to_vec()).expect("a road").into()
}

#[test]
fn a_store_does_not_grow_with_its_runs() {
    let folder = six_runs();
    let at = folder.path();
    let mut sizes = Vec::new();
    for number in 0..6 {
        let run = format!("{number}.csv");
        fuse(at, &["--store", "sums.csv", &run]).success();
        sizes.push(lines(&folder, "sums.csv"));
    }
    assert!(sizes.iter().all(|&size| size == sizes[0]), "{sizes:?}");
    // The cells of a session are stored once.
    let mut sizes = Vec::new();
    for number in 0..4 {
        let run = format!("day={number}.csv");
        fuse(at, &["--store", "named.csv", "--session", &run]).success();
        sizes.push(lines(&folder, "named.csv"));
    }
    assert!(sizes[3] - sizes[0] < 10, "{sizes:?}");
    assert!(sizes[0] < 2 * 2410, "{sizes:?}");
}

#[test]
fn a_store_of_another_road_is_refused() {
    let folder = six_runs();
    let at = folder.path();
    let elsewhere = run(&moved(&hills(), 0.0, 3.0));
    run::write(&at.join("beside.csv"), &elsewhere).expect("written");
    fuse(at, &["beside.csv"]).success();
    fs::rename(at.join("map.csv"), at.join("road.csv")).expect("moved");
    fuse(at, &["--store", "sums.csv", "0.csv"]).success();
    let (map, sums) = (text(&folder, "map.csv"), text(&folder, "sums.csv"));
    fuse(at, &["--store", "sums.csv", "--road", "road.csv", "1.csv"])
        .code(1)
        .stderr(contains("sums.csv: the store has another road"));
    // A run that drives elsewhere, or in the other direction, changes nothing either.
    let away = run(&moved(&hills(), 90e3, 0.0));
    let back = run(&reversed(&hills()));
    for (name, rows) in [("away.csv", away), ("back.csv", back)] {
        run::write(&at.join(name), &rows).expect("written");
        fuse(at, &["--store", "sums.csv", name])
            .code(1)
            .stderr(contains(name).and(contains("expected runs over the road")));
    }
    assert_eq!(text(&folder, "map.csv"), map);
    assert_eq!(text(&folder, "sums.csv"), sums);
}

#[test]
fn both_files_appear_or_neither() {
    let folder = six_runs();
    let at = folder.path();
    fs::create_dir(at.join("folder")).expect("a folder");
    // A map that cannot be written: no store.
    let arguments = ["fuse", "--out", "folder", "--store", "sums.csv", "0.csv"];
    roadgrade(at, &arguments)
        .code(1)
        .stderr(contains("folder: "));
    assert!(!at.join("sums.csv").exists());
    // A store that cannot be written: no map.
    fuse(at, &["--store", "folder", "0.csv"])
        .code(1)
        .stderr(contains("folder: "));
    fuse(at, &["--store", "0.csv/sums.csv", "0.csv"]).code(1);
    // A run that is broken: neither.
    fs::write(at.join("bad.csv"), "nonsense\n").expect("written");
    fuse(at, &["--store", "sums.csv", "--session", "x=0.csv,bad.csv"])
        .code(1)
        .stderr(contains("bad.csv:"));
    assert!(!at.join("map.csv").exists() && !at.join("sums.csv").exists());
    assert_eq!(
        fs::read_dir(at).expect("listed").count(),
        8,
        "six runs, the folder, the broken run, nothing half written"
    );
}

#[test]
fn wrong_usage_is_reported_as_such() {
    let folder = six_runs();
    let at = folder.path();
    for session in ["0.csv", "=0.csv", "x=", "x=0.csv,,1.csv", "a\tb=0.csv"] {
        fuse(at, &["--session", session])
            .code(2)
            .stderr(contains("expected"));
    }
    fuse(at, &["--store", "map.csv", "0.csv"])
        .code(2)
        .stderr(contains("the same file"));
    fuse(at, &["--store", "absent.csv"])
        .code(1)
        .stderr(contains("absent.csv: "));
    assert!(!at.join("map.csv").exists());
}

/// Returns the first lines of a store with one session.
fn small_store(folder: &TempDir) -> Vec<String> {
    let at = folder.path();
    for (name, number) in [("a.csv", 0), ("b.csv", 1), ("c.csv", 2)] {
        run::write(&at.join(name), &wavy(number)[..9]).expect("written");
    }
    fuse(
        at,
        &[
            "--store",
            "sums.csv",
            "a.csv",
            "--session",
            "day=b.csv,c.csv",
        ],
    )
    .success();
    let text = text(folder, "sums.csv");
    fs::remove_file(at.join("map.csv")).expect("removed");
    text.lines().map(str::to_owned).collect()
}

#[test]
fn broken_stores_are_reported_with_file_and_line() {
    let folder = six_runs();
    let good = small_store(&folder);
    let road_rows = good.iter().filter(|line| line.contains(",,4")).count();
    assert!(road_rows >= 7, "{good:?}");
    let last_row = good.iter().filter(|line| !is_run(line)).count();
    // Lines count from 1; the first row of the road is line 3.
    let first_of_session = 3 + road_rows;
    assert!(good[first_of_session - 1].contains(",day,,"), "{good:?}");
    let with = |line: usize, change: &dyn Fn(&mut Vec<String>)| {
        let mut lines = good.clone();
        let mut fields: Vec<String> = lines[line - 1].split(',').map(str::to_owned).collect();
        change(&mut fields);
        lines[line - 1] = fields.join(",");
        lines.join("\n") + "\n"
    };
    let set = |line: usize, column: usize, value: &str| {
        with(line, &|fields| fields[column] = value.into())
    };
    let session = |column: usize, value: &str| set(first_of_session + 1, column, value);
    let at_session = |problem: &str| format!("sums.csv:{}: {problem}", first_of_session + 1);
    let replaced = |line: usize, text: &str| {
        let mut lines = good.clone();
        lines[line - 1] = text.to_owned();
        lines.join("\n") + "\n"
    };
    let cases = [
        (String::new(), "sums.csv:1: not a store".to_owned()),
        (
            replaced(1, "# roadgrade sums 3, rows: 14, runs: 3"),
            "sums.csv:1: not a store of this version; expected".to_owned(),
        ),
        (
            good[1..].join("\n"),
            "sums.csv:1: not a store of this version".to_owned(),
        ),
        (
            [&good[..last_row - 1], &good[last_row..]]
                .concat()
                .join("\n")
                + "\n",
            format!("rows; expected the {} of its first line", last_row - 2),
        ),
        (
            set(2, 1, "truck"),
            "sums.csv:1: unknown column `truck`".to_owned(),
        ),
        (
            with(5, &|fields| drop(fields.pop())),
            "sums.csv:5: 10 fields under a header of 11".to_owned(),
        ),
        (
            set(5, 0, "3.1"),
            "sums.csv:5: distance_m is 3.1; expected a multiple of 2.5".to_owned(),
        ),
        (
            set(5, 0, "7.5"),
            "sums.csv:5: distance_m is 7.5 after 2.5".to_owned(),
        ),
        (set(5, 2, "95"), "sums.csv:5: latitude_deg is 95".to_owned()),
        (
            set(5, 2, ""),
            "sums.csv:5: a cell of the road without a position".to_owned(),
        ),
        (
            set(3, 1, "day"),
            "sums.csv:3: a position in a row of a session".to_owned(),
        ),
        (set(5, 5, "NaN"), "sums.csv:5: weight is NaN".to_owned()),
        (
            set(5, 5, "-4"),
            "sums.csv:5: sums that are impossible for 1 runs".to_owned(),
        ),
        (
            set(5, 6, "1"),
            "sums.csv:5: sums that are impossible for 1 runs".to_owned(),
        ),
        (
            set(5, 8, "1e-9"),
            "sums.csv:5: sums that are impossible for 1 runs".to_owned(),
        ),
        (
            set(5, 4, "0"),
            "sums.csv:5: sums that are impossible for 0 runs".to_owned(),
        ),
        (set(5, 4, "-1"), "sums.csv:5: runs: ".to_owned()),
        (
            session(9, "-1"),
            at_session("sums that are impossible for 2 runs"),
        ),
        (session(0, "0"), at_session("distance_m is 0 after")),
        (session(1, "a"), at_session("sessions out of order")),
        (session(1, " "), at_session("sessions out of order")),
        (
            set(last_row, 0, "1000"),
            format!("sums.csv:{last_row}: distance_m is 1000"),
        ),
    ];
    let at = folder.path();
    for (text, message) in cases {
        fs::write(at.join("sums.csv"), &text).expect("written");
        let assert = fuse(at, &["--store", "sums.csv", "a.csv"]).code(1);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(stderr.contains(&message), "{message}: {stderr}");
        assert!(!at.join("map.csv").exists(), "{message}");
        assert_eq!(
            fs::read_to_string(at.join("sums.csv")).expect("text"),
            text,
            "{message}"
        );
    }
    // The unchanged store is accepted.
    fs::write(at.join("sums.csv"), good.join("\n") + "\n").expect("written");
    fuse(at, &["--store", "sums.csv", "a.csv"]).success();
}
