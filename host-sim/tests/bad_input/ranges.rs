//! Numbers out of range in every column of every table.

use crate::shell::{done, refused, runs};
use std::fs;
use std::path::Path;

/// Replaces the value of a column in a line, which counts from 1.
fn with(text: &str, line: usize, column: usize, value: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut fields: Vec<&str> = lines[line - 1].split(',').collect();
    fields[column] = value;
    lines[line - 1] = fields.join(",");
    lines.join("\n") + "\n"
}

/// Checks that a command refuses huge numbers in every column of a file that has this content, and
/// names line, column, value and range.
fn check(folder: &Path, name: &str, good: &str, arguments: &[&str]) {
    let header: Vec<&str> = good.lines().next().unwrap().split(',').collect();
    for (column, title) in header.iter().enumerate() {
        if ["runs", "shifting", "braking"].contains(title) {
            continue;
        }
        if *title == "valid" || title.ends_with("consistent") {
            fs::write(folder.join(name), with(good, 4, column, "2")).unwrap();
            let message = refused(folder, arguments);
            let expected = format!("{name}:4: {title} is 2; expected 0 or 1");
            assert!(message.contains(&expected), "{message}");
            continue;
        }
        for value in ["1e308", "-1e308", "NaN", "inf"] {
            fs::write(folder.join(name), with(good, 4, column, value)).unwrap();
            let message = refused(folder, arguments);
            let shown: f64 = value.parse().unwrap();
            let expected = format!("{name}:4: {title} is {shown}; expected ");
            let range = message.split_once(&expected).unwrap_or_else(|| {
                panic!("{expected}: {message}");
            });
            let has_range = ["a finite number from ", "degrees within "]
                .iter()
                .any(|words| range.1.starts_with(words));
            assert!(has_range, "{message}");
        }
    }
    fs::write(folder.join(name), good).unwrap();
}

#[test]
fn every_column_of_a_run_and_of_a_map_has_a_range() {
    let folder = runs(20, 1);
    let at = folder.path();
    let run = fs::read_to_string(at.join("0.csv")).unwrap();
    check(
        at,
        "0.csv",
        &run,
        &["fuse", "--out", "map.csv", "--store", "s.csv", "0.csv"],
    );
    assert!(!at.join("map.csv").exists() && !at.join("s.csv").exists());
    done(at, &["fuse", "--out", "map.csv", "0.csv"]);
    let map = fs::read_to_string(at.join("map.csv")).unwrap();
    check(
        at,
        "map.csv",
        &map,
        &["export", "map.csv", "--out", "map.geojson"],
    );
    let road = "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent\n\
                0,47,8,400,1\n10,47.0001,8,400,1\n20,47.0002,8,400,1\n";
    check(
        at,
        "road.csv",
        road,
        &["fuse", "--out", "m.csv", "--road", "road.csv", "0.csv"],
    );
    let truth = "time_s,distance_m,grade_percent,altitude_m,shifting,braking\n\
                 0,0,1,400,0,0\n1,25,1,400,0,0\n2,50,1,400,0,0\n";
    check(at, "t.csv", truth, &["score", "--truth", "t.csv", "0.csv"]);
}

#[test]
fn a_flipped_bit_of_a_latitude_does_not_put_a_run_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let vehicle = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
                   rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
                   [traction]\nsource = \"force\"\n";
    fs::write(at.join("v.toml"), vehicle).unwrap();
    let log = |flip: Option<u32>| {
        let header =
            "time_s,wheel_speed_mps,traction_force_n,latitude_deg,longitude_deg,altitude_m\n";
        let rows = (0..120).map(|second| {
            let e7 = 471_000_000 + 2_250 * second;
            let e7 = match flip {
                Some(bit) if second == 60 => e7 ^ (1 << bit),
                _ => e7,
            };
            let degrees = f64::from(e7) * 1e-7;
            format!("{second},25,6000,{degrees:.7},8.5,400\n")
        });
        header.to_owned() + &rows.collect::<String>()
    };
    for flip in 0..31 {
        let text = log(Some(flip));
        fs::write(at.join("d.csv"), &text).unwrap();
        let arguments = [
            "estimate",
            "--vehicle",
            "v.toml",
            "--out",
            "run.csv",
            "d.csv",
        ];
        let output = crate::shell::limited(at, &arguments);
        if output.status.code() == Some(1) {
            continue;
        }
        let run = fs::read_to_string(at.join("run.csv")).unwrap();
        let latitudes = run
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(2).unwrap());
        for latitude in latitudes.filter(|text| !text.is_empty()) {
            let latitude: f64 = latitude.parse().unwrap();
            assert!((latitude - 47.1).abs() < 0.05, "bit {flip}: {latitude}");
        }
        fs::remove_file(at.join("run.csv")).unwrap();
    }
}
