//! Maps that are made of logs alone.

use super::trucks::{LIGHT, simulate};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use test_kit::command::{folder, program, roadgrade};
use test_kit::tables::columns;

fn numbers(columns: &BTreeMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    columns[name]
        .iter()
        .map(|field| field.parse().unwrap())
        .collect()
}

/// RMSE of a map's grade against that of its road, %, but for the first and last 500 m.
fn rmse_percent(map: &Path, road: &Path) -> f64 {
    let (map, road) = (columns(map), columns(road));
    let (at_m, grades) = (numbers(&map, "distance_m"), numbers(&map, "grade_percent"));
    let (road_m, truth) = (
        numbers(&road, "distance_m"),
        numbers(&road, "grade_percent"),
    );
    let (mut sum, mut count) = (0.0, 0.0);
    for (at_m, grade) in at_m.iter().zip(grades) {
        if *at_m < 500.0 || *at_m > road_m[road_m.len() - 1] - 500.0 {
            continue;
        }
        let next = road_m.partition_point(|m| m < at_m).max(1);
        let part = (at_m - road_m[next - 1]) / (road_m[next] - road_m[next - 1]);
        let true_percent = truth[next - 1] + part * (truth[next] - truth[next - 1]);
        sum += (grade - true_percent).powi(2);
        count += 1.0;
    }
    (sum / count).sqrt()
}

#[test]
fn logs_alone_give_a_map_a_vehicle_and_a_page() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 15_000.0, true);
    let arguments = ["map", "--out", "out", "--road", "road.csv", "light.log"];
    let done = roadgrade(path, &arguments).success();
    assert!(String::from_utf8_lossy(&done.get_output().stdout).contains("| light |"));
    let rmse = rmse_percent(&path.join("out/map.csv"), &path.join("road.csv"));
    assert!(rmse < 0.1, "{rmse}");
    let page = fs::read_to_string(path.join("out/index.html")).unwrap();
    for words in [
        "Consistent: the signals agree",
        "altitude (m)",
        "mass, kg",
        "Plan",
        "Along the road",
        "Runs",
        "Vehicle",
        "assumed ±",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Nothing is fetched; one place can be opened.
    assert!(!page.contains("src=\"http"));
    assert_eq!(page.matches("href=\"http").count(), 1);
    assert!(page.contains("href=\"https://www.openstreetmap.org/?mlat="));
    // The grade of a single run is that of the map.
    assert!(!page.contains("each_run_0") && !page.contains("Number of runs."));
}

#[test]
fn a_road_that_is_driven_both_ways_has_a_way_for_each() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 8_000.0, true);
    let logs = ["light.log", "light_back.log"];
    let arguments = [
        &["map", "--out", "out", "--vehicle", "light.toml"][..],
        &logs,
    ]
    .concat();
    roadgrade(path, &arguments).success();
    let map = columns(&path.join("out/map.csv"));
    let mut lengths: BTreeMap<&str, f64> = BTreeMap::new();
    for way in &map["way"] {
        *lengths.entry(way).or_default() += 2.5;
    }
    assert_eq!(lengths.len(), 2, "{lengths:?}");
    assert!(
        lengths.values().all(|m| (m - 8_000.0).abs() < 200.0),
        "{lengths:?}"
    );
    // There and back, the road climbs by opposite amounts.
    let climb = |way: &str| {
        let grades = numbers(&map, "grade_percent");
        let own = map["way"]
            .iter()
            .zip(grades)
            .filter(|(name, _)| *name == way);
        own.map(|(_, grade)| 0.025 * grade).sum::<f64>()
    };
    let climbs: Vec<f64> = lengths.keys().map(|way| climb(way)).collect();
    assert!((climbs[0] + climbs[1]).abs() < 5.0, "{climbs:?}");
}

#[test]
fn parts_of_a_drive_are_joined() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 6_000.0, false);
    let text = fs::read_to_string(path.join("light.log")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let (first, second) = lines.split_at(lines.len() / 2);
    fs::write(path.join("part1.log"), first.join("\n") + "\n").unwrap();
    fs::write(path.join("part2.log"), second.join("\n") + "\n").unwrap();
    let map = |out: &str, more: &[&str]| {
        let arguments = ["map", "--out", out, "--vehicle", "light.toml"];
        roadgrade(path, &[&arguments[..], more].concat()).success();
    };
    map("whole", &["light.log"]);
    map("joined", &["--join", "part1.log", "part2.log"]);
    let read = |file: &str| fs::read_to_string(path.join(file)).unwrap();
    assert_eq!(read("whole/runs/light.csv"), read("joined/runs/part1.csv"));
    assert_eq!(read("whole/map.csv"), read("joined/map.csv"));
}

#[test]
fn standard_input_is_read_as_often_as_it_takes() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 4_000.0, false);
    let log = fs::read(path.join("light.log")).unwrap();
    roadgrade(path, &["map", "--out", "file", "light.log"]).success();
    let mut piped = program();
    piped.current_dir(path).args(["map", "--out", "piped", "-"]);
    piped.write_stdin(log).assert().success();
    let read = |file: &str| fs::read_to_string(path.join(file)).unwrap();
    assert_eq!(read("file/map.csv"), read("piped/map.csv"));
    assert!(path.join("piped/runs/stdin.csv").exists());
}
