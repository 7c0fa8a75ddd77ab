//! `--quiet`, `--json`, completions and man pages.

use crate::drive::{done, drive, estimate};
use serde_json::Value as Json;
use std::fs;

#[test]
fn quiet_leaves_out_messages_and_keeps_tables_and_warnings() {
    let folder = drive();
    let at = folder.path();
    let arguments = ["estimate", "--vehicle", "v.toml", "--out", "r.csv", "d.log"];
    let printed = done(at, &[&arguments[..], &["--quiet"]].concat());
    assert!(printed.stderr.is_empty(), "{printed:?}");
    assert!(!printed.stdout.is_empty());
    let printed = done(at, &["-q", "fuse", "--out", "map.csv", "r.csv"]);
    assert!(printed.stderr.is_empty(), "{printed:?}");
    let heavy = fs::read_to_string(at.join("v.toml")).unwrap();
    fs::write(
        at.join("v.toml"),
        heavy.replace("reference_torque_nm = ", "reference_torque_nm = 4"),
    )
    .unwrap();
    let printed = done(at, &[&arguments[..], &["--quiet"]].concat());
    let lines = String::from_utf8(printed.stderr).unwrap();
    assert!(
        lines.lines().all(|line| line.starts_with("warning: ")),
        "{lines}"
    );
}

#[test]
fn fuse_prints_json() {
    let folder = drive();
    let at = folder.path();
    estimate(at, "r.csv");
    let printed = done(at, &["fuse", "--json", "--out", "map.csv", "r.csv"]);
    let json: Json = serde_json::from_slice(&printed.stdout).unwrap();
    let cells = fs::read_to_string(at.join("map.csv"))
        .unwrap()
        .lines()
        .count()
        - 1;
    assert_eq!(json["cells"], cells);
    assert_eq!(json["map"], "map.csv");
}

#[test]
fn completions_and_man_pages_know_every_command() {
    let folder = drive();
    let at = folder.path();
    for shell in ["bash", "zsh", "fish"] {
        let script = done(at, &["completions", shell]).stdout;
        let script = String::from_utf8(script).unwrap();
        for word in ["estimate", "diagnose", "tuning"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    done(at, &["man", "--out", "man"]);
    for (page, word) in [
        ("roadgrade.1", "SUBCOMMANDS"),
        ("roadgrade-estimate.1", "kept"),
    ] {
        let text = fs::read_to_string(at.join("man").join(page)).unwrap();
        assert!(
            text.contains(word) && text.starts_with(".ie"),
            "{page}: {text}"
        );
    }
    assert!(!at.join("man/roadgrade-man.1").exists());
}
