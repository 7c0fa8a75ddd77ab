//! `roadgrade place`: runs as they lie on their road, for an engine to sum.

use assert_cmd::assert::Assert;
use host_sim::files::parquet;
use host_sim::files::run::{self, RunRow};
use host_sim::map::read_map_ways;
use predicates::prelude::*;
use predicates::str::contains;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use test_kit::command::{folder, roadgrade};
use test_kit::roads::network::{save, way};
use test_kit::roads::{hills, moved, reversed, run, with_position_noise};

fn place(at: &Path, arguments: &[&str]) -> Assert {
    roadgrade(at, &[&["place"][..], arguments].concat())
}

/// Writes four runs as Parquet, and a network of three ways, one of both directions.
fn files(at: &Path) {
    let spots = hills();
    fs::create_dir(at.join("runs")).expect("made");
    for seed in 0..4 {
        let mut driven = with_position_noise(&spots, 3.0, 80.0, seed);
        if seed == 3 {
            driven = reversed(&driven);
        }
        let mut rows: Vec<RunRow> = run(&driven);
        for row in &mut rows {
            row.grade_percent += 0.01 * seed as f64;
            row.grade_sigma_percent = 0.1 + 0.02 * seed as f64;
        }
        run::write(&at.join(format!("runs/{seed}.parquet")), &rows).expect("written");
    }
    let ways = [
        way("a", "yes", &spots[..=800]),
        way("b", "no", &spots[800..=1600]),
        way("c", "yes", &spots[1600..]),
    ];
    save(&at.join("net.geojson"), &ways);
}

/// Returns the files of a folder with their bytes, by name.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("listed");
    let paths = entries.map(|entry| entry.expect("listed").path());
    paths
        .map(|path| {
            let bytes = fs::read(&path).expect("read");
            (path.file_name().expect("a name").into(), bytes)
        })
        .collect()
}

/// Returns the weighted mean of the grade in each cell of placed runs.
fn means(folder: &Path) -> BTreeMap<(String, String, i64), f64> {
    let mut sums: BTreeMap<_, (f64, f64)> = BTreeMap::new();
    for name in contents(folder).keys() {
        let names = ["cell", "grade_percent", "grade_variance_percent2"];
        let path = folder.join(name);
        let file = parquet::open(&path).expect("opened");
        file.read_texts(names, ["way", "direction"], |numbers, texts| {
            let [cell, grade_percent, variance] = numbers.map(|number| number.expect("a number"));
            let [way, direction] = texts.map(|text| text.unwrap_or_default().to_owned());
            let sum = sums.entry((way, direction, cell as i64)).or_default();
            sum.0 += grade_percent / variance;
            sum.1 += 1.0 / variance;
            Ok(())
        })
        .expect("read");
    }
    let mean = |(cell, (grade, weight)): (_, (f64, f64))| (cell, grade / weight);
    sums.into_iter().map(mean).collect()
}

#[test]
fn placed_runs_of_a_network_sum_to_its_map() {
    let folder = folder();
    let at = folder.path();
    files(at);
    let road = ["--road", "net.geojson"];
    let fuse = [
        &["fuse", "--out", "net.parquet", "--placed", "fused"][..],
        &road,
    ]
    .concat();
    roadgrade(at, &[&fuse[..], &["runs"]].concat()).success();
    // Two processes, each with its part of the runs.
    for part in [
        ["runs/0.parquet", "runs/3.parquet"],
        ["runs/1.parquet", "runs/2.parquet"],
    ] {
        place(
            at,
            &[&road[..], &["--out", "placed", "--json"], &part].concat(),
        )
        .success()
        .stdout(contains(r#""placed":2"#).and(contains(r#""there":0"#)));
    }
    let placed = at.join("placed/road=net");
    assert_eq!(contents(&placed), contents(&at.join("fused/road=net")));
    let means = means(&placed);
    let map = read_map_ways(&at.join("net.parquet")).expect("a map");
    assert_eq!(map.len(), 4);
    let mut cells = 0;
    for way in &map {
        let name = way.name.as_ref().expect("a name");
        for row in &way.rows {
            let cell = (row.distance_m / 2.5).round() as i64;
            let key = (name.way.clone(), name.direction.word().to_owned(), cell);
            assert!((means[&key] - row.grade_percent).abs() < 1e-9, "{row:?}");
            cells += 1;
        }
    }
    assert_eq!(cells, means.len());
}

#[test]
fn a_process_that_was_interrupted_goes_on() {
    let folder = folder();
    let at = folder.path();
    files(at);
    let all = ["--road", "net.geojson", "--out", "placed", "runs"];
    place(at, &all)
        .success()
        .stderr(contains("4 runs placed, 0 there"));
    let placed = at.join("placed/road=net");
    let whole = contents(&placed);
    assert_eq!(whole.len(), 4);
    place(at, &all)
        .success()
        .stderr(contains("0 runs placed, 4 there"));
    let lost = whole.keys().next().expect("a run");
    fs::remove_file(placed.join(lost)).expect("removed");
    place(at, &all)
        .success()
        .stderr(contains("1 runs placed, 3 there"));
    assert_eq!(contents(&placed), whole);

    // Another road of the same name: all are placed again.
    let spots = hills();
    save(&at.join("net.geojson"), &[way("a", "yes", &spots)]);
    place(at, &all)
        .success()
        .stderr(contains("3 runs placed, 0 there"));
}

#[test]
fn what_cannot_be_placed_is_told() {
    let folder = folder();
    let at = folder.path();
    files(at);
    save(
        &at.join("far.geojson"),
        &[way("a", "yes", &moved(&hills(), 900.0, -900.0))],
    );
    place(at, &["--road", "far.geojson", "--out", "far", "runs"])
        .success()
        .stderr(contains("4 without a cell on the road"));
    assert!(!at.join("far").exists());
    fs::write(at.join("runs/damaged.parquet"), "PAR1").expect("written");
    let all = ["--road", "net.geojson", "--out", "placed", "runs"];
    place(at, &all)
        .success()
        .stderr(contains("damaged.parquet").and(contains("4 runs placed")));
    place(at, &[&all[..], &["--strict"]].concat())
        .code(1)
        .stderr(contains("damaged.parquet"));
    place(
        at,
        &[
            "--road",
            "net.geojson",
            "--out",
            "placed",
            "runs/damaged.parquet",
        ],
    )
    .code(1)
    .stderr(contains("damaged.parquet"));
    place(at, &["--road", "none.geojson", "--out", "placed", "runs"])
        .code(1)
        .stderr(contains("none.geojson"));
}
