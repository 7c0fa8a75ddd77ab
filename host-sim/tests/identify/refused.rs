//! What `identify` and `map` refuse, and with which words.

use super::trucks::{LIGHT, simulate, without};
use predicates::str::contains;
use std::fs;
use test_kit::command::{folder, roadgrade};

#[test]
fn wrong_usage_is_told_before_anything_is_read() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("a.log"), "").unwrap();
    let cases: [(&[&str], &str); 3] = [
        (
            &["identify", "--out", "v.toml", "--like", "truck4t", "a.log"],
            "expected a vehicle file, or one of bus, car, truck12t, truck40t, van",
        ),
        (&["identify", "--out", "v.csv", "a.log"], "expected .toml"),
        (&["map", "a.log"], "--out <DIR>"),
    ];
    for (arguments, words) in cases {
        roadgrade(path, arguments).code(2).stderr(contains(words));
    }
}

#[test]
fn a_missing_signal_is_named() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 2_000.0, false);
    for (pgn, words) in [
        ("F004", "no torque: expected EEC1"),
        ("FEF1", "no speed: expected wheel-based speed"),
        ("F805", "no GNSS altitude: expected NMEA 2000 129029"),
    ] {
        // Without the front axle's speed, too.
        without(path, "light.log", "part.log", &[pgn, "FEBF"]);
        let arguments = ["identify", "--out", "v.toml", "part.log"];
        roadgrade(path, &arguments).code(1).stderr(contains(words));
        assert!(!path.join("v.toml").exists());
    }
}

#[test]
fn a_log_that_cannot_be_estimated_is_left_out_of_the_map() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 6_000.0, false);
    without(path, "light.log", "deaf.log", &["F805"]);
    let arguments = [
        "map",
        "--out",
        "out",
        "--vehicle",
        "light.toml",
        "light.log",
        "deaf.log",
    ];
    roadgrade(path, &arguments)
        .success()
        .stderr(contains("warning: left out: deaf.log: no GNSS altitude"));
    assert!(path.join("out/runs/light.csv").exists());
    assert!(!path.join("out/runs/deaf.csv").exists());
    let page = fs::read_to_string(path.join("out/index.html")).unwrap();
    assert!(page.contains("Left out: deaf.log"));
    let arguments = [
        "map",
        "--out",
        "none",
        "--vehicle",
        "light.toml",
        "deaf.log",
    ];
    roadgrade(path, &arguments).code(1);
    assert!(!path.join("none").exists());
}

#[test]
fn a_log_that_cannot_be_read_is_left_out_of_the_identification_too() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 6_000.0, false);
    fs::write(path.join("empty.log"), "").unwrap();
    fs::write(path.join("noise.log"), [0x9c; 3000]).unwrap();
    let text = fs::read_to_string(path.join("light.log")).unwrap();
    let stands: Vec<&str> = text.lines().take(300).collect();
    fs::write(path.join("stands.log"), stands.join("\n") + "\n").unwrap();
    let logs = ["empty.log", "noise.log", "stands.log", "light.log"];
    let identify = ["identify", "--out", "v.toml"];
    roadgrade(path, &[&identify[..], &logs].concat())
        .success()
        .stderr(contains("warning: left out: empty.log: the file is empty"))
        .stderr(contains(
            "warning: left out: noise.log: unknown format, begins with `",
        ));
    let map = ["map", "--out", "out"];
    roadgrade(path, &[&map[..], &logs].concat())
        .success()
        .stderr(contains("warning: left out: empty.log: the file is empty"))
        .stderr(contains("warning: left out: stands.log: "));
    // A missing file is a mistake of the command, and so is any damage if it is strict.
    let missing = [&identify[..], &["light.log", "no.log"]].concat();
    roadgrade(path, &missing)
        .code(1)
        .stderr(contains("no.log: "));
    let strict = [&identify[..], &["--strict"], &logs].concat();
    roadgrade(path, &strict).code(1);
    let none = [&identify[..], &["empty.log", "noise.log"]].concat();
    roadgrade(path, &none)
        .code(1)
        .stderr(contains("empty.log: "));
}

#[test]
fn drives_that_overlap_in_time_are_told() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 6_000.0, false);
    let text = fs::read_to_string(path.join("light.log")).unwrap();
    let absolute = |line: &str| {
        let (seconds, rest) = line[1..].split_once('.').unwrap();
        let seconds: u64 = seconds.parse().unwrap();
        format!("({}.{rest}", 1_700_000_000 + seconds)
    };
    let lines: Vec<String> = text.lines().map(absolute).collect();
    let part = |lines: &[String]| lines.join("\n") + "\n";
    let third = lines.len() / 3;
    fs::write(path.join("one.log"), part(&lines[..2 * third])).unwrap();
    fs::write(path.join("two.log"), part(&lines[third..])).unwrap();
    fs::write(path.join("rest.log"), part(&lines[2 * third..])).unwrap();
    let map = |logs: &[&str]| {
        let arguments = ["map", "--out", "out", "--vehicle", "light.toml"];
        roadgrade(path, &[&arguments[..], logs].concat()).success()
    };
    map(&["one.log", "two.log"]).stderr(contains("warning: one and two overlap by "));
    let page = fs::read_to_string(path.join("out/index.html")).unwrap();
    assert!(page.contains("one and two overlap by "));
    let apart = map(&["one.log", "rest.log"]);
    let told = String::from_utf8_lossy(&apart.get_output().stderr).into_owned();
    assert!(!told.contains("overlap"), "{told}");
}

#[test]
fn a_drive_that_is_given_twice_counts_once() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 4_000.0, false);
    fs::copy(path.join("light.log"), path.join("copy.log")).unwrap();
    let map = |out: &str, logs: &[&str]| {
        let arguments = ["map", "--out", out, "--vehicle", "light.toml"];
        roadgrade(path, &[&arguments[..], logs].concat()).success()
    };
    map("one", &["light.log"]);
    map("two", &["light.log", "copy.log"]).stderr(contains(
        "warning: left out: copy.log: the same drive as light",
    ));
    let read = |file: &str| fs::read_to_string(path.join(file)).unwrap();
    assert_eq!(read("one/map.csv"), read("two/map.csv"));
}

#[test]
fn a_file_in_place_of_the_folder_is_told_before_the_work() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("out"), "mine").unwrap();
    let arguments = ["map", "--out", "out", "no.log"];
    let refused = roadgrade(path, &arguments).code(1);
    refused.stderr(contains("out: is a file; expected a folder"));
}
