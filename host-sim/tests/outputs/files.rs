//! Devices, pipes, links, standard output; names and folders that cannot be.

use crate::drive::{done, drive, estimate, refused};
use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;
use std::thread;

#[test]
fn a_dash_is_standard_output_and_nothing_else_is_printed_there() {
    let folder = drive();
    let at = folder.path();
    estimate(at, "r.csv");
    let run = fs::read(at.join("r.csv")).unwrap();
    let printed = estimate(at, "-");
    assert!(printed.stdout == run);
    assert!(
        String::from_utf8(printed.stderr)
            .unwrap()
            .contains("verdict")
    );
    assert!(!at.join("-").exists());
    done(at, &["fuse", "--out", "map.csv", "r.csv"]);
    let map = fs::read(at.join("map.csv")).unwrap();
    assert!(done(at, &["fuse", "--out", "-", "r.csv"]).stdout == map);
}

#[test]
fn a_link_stays_and_its_target_is_written() {
    let folder = drive();
    let at = folder.path();
    fs::create_dir(at.join("else")).unwrap();
    symlink("else/r.csv", at.join("link.csv")).unwrap();
    // The target does not exist yet, and then does.
    for _ in 0..2 {
        estimate(at, "link.csv");
        assert!(at.join("link.csv").is_symlink());
        assert!(at.join("else/r.csv").is_file());
        assert!(!at.join("else/r.csv").is_symlink());
    }
}

#[test]
fn a_pipe_is_written_through_whatever_its_name() {
    let folder = drive();
    let at = folder.path();
    estimate(at, "r.csv");
    let run = fs::read(at.join("r.csv")).unwrap();
    let made = Command::new("mkfifo").arg(at.join("pipe")).status();
    assert!(made.unwrap().success());
    let pipe = at.join("pipe");
    let reader = thread::spawn(move || fs::read(pipe).unwrap());
    estimate(at, "pipe");
    assert!(reader.join().unwrap() == run);
    assert!(!at.join("pipe").is_file());
    // A name of standard output.
    assert!(estimate(at, "/dev/stdout").stdout.starts_with(&run));
}

#[test]
fn an_unknown_ending_is_wrong_usage_that_names_the_known_ones() {
    let folder = drive();
    let at = folder.path();
    for out in ["r.xyz", "r.txt", "r.csv.gz"] {
        let arguments = ["estimate", "--vehicle", "v.toml", "--out", out, "d.log"];
        let message = refused(at, 2, &arguments);
        assert!(message.contains("expected .csv or .parquet"), "{message}");
        assert!(!at.join(out).exists());
    }
    estimate(at, "r.csv");
    let message = refused(at, 2, &["fuse", "--out", "m.dat", "r.csv"]);
    assert!(message.contains("expected .csv or .parquet"), "{message}");
}

#[test]
fn a_missing_folder_is_told_before_the_work() {
    let folder = drive();
    let at = folder.path();
    let options = ["--out", "--page", "--kept"];
    for (option, name) in options.into_iter().zip(["no/r.csv", "no/r.html", "no/k"]) {
        let mut arguments = vec!["estimate", "--vehicle", "v.toml", option, name];
        if option != "--out" {
            arguments.extend(["--out", "r.csv"]);
        }
        // The log is not even opened.
        arguments.push("missing.log");
        let message = refused(at, 1, &arguments);
        assert!(message.contains("there is no folder no"), "{message}");
        assert!(!at.join("no").exists());
    }
    estimate(at, "r.csv");
    let message = refused(at, 1, &["fuse", "--out", "no/m.csv", "missing.csv"]);
    assert!(message.contains("there is no folder no"), "{message}");
    let message = refused(at, 1, &["export", "missing.csv", "--out", "no/m.kml"]);
    assert!(message.contains("there is no folder no"), "{message}");
}

#[test]
fn a_day_is_one_of_the_calendar() {
    let folder = drive();
    let at = folder.path();
    for day in ["2026-02-31", "2026-2-3", "2026-02-29", "yesterday"] {
        let mut arguments = vec!["estimate", "--vehicle", "v.toml", "--out", "r.csv"];
        arguments.extend(["--day", day, "d.log"]);
        let message = refused(at, 2, &arguments);
        assert!(message.contains("expected YYYY-MM-DD"), "{message}");
    }
}
