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

#[test]
fn every_command_that_computes_prints_json() {
    let folder = test_kit::command::folder();
    let path = folder.path();
    let scenario = "[road]\nlength_m = 4000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(path.join("s.toml"), scenario).unwrap();
    let json = |arguments: &[&str]| {
        let done = test_kit::command::roadgrade(path, arguments).success();
        let output = done.get_output().stdout.clone();
        serde_json::from_slice::<Json>(&output).unwrap_or_else(|e| panic!("{arguments:?}: {e}"))
    };
    let runs = json(&["simulate", "--json", "--scenario", "s.toml", "--out", "."]);
    assert_eq!(
        (&runs[0]["run"], &runs[0]["distance_km"]),
        (&"a".into(), &4.0.into())
    );
    let vehicle = ["--vehicle", "a.vehicle.toml"];
    json(
        &[
            &["estimate", "--json", "--out", "a.csv"][..],
            &vehicle,
            &["a.log"],
        ]
        .concat(),
    );
    json(&["fuse", "--json", "--out", "map.csv", "a.csv"]);
    let exported = json(&["export", "--json", "--out", "map.kml", "map.csv"]);
    assert_eq!(
        (&exported["ways"], &exported["out"]),
        (&1.into(), &"map.kml".into())
    );
    assert!(exported["cells"].as_u64().unwrap() > 1_000);
    json(&["pack", "--json", "--out", "map.grade", "map.csv"]);
    let horizon = [
        "horizon",
        "--json",
        "--map",
        "map.grade",
        "--out",
        "ahead.csv",
    ];
    let ahead = json(&[&horizon[..], &vehicle, &["a.log"]].concat());
    assert!(ahead["times"].as_u64().unwrap() > 50, "{ahead}");
}
