//! What reaches the terminal, and a terminal that is gone.

use crate::shell::{done, runs};
use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::process::Command;

#[test]
fn a_closed_stderr_does_not_end_the_work() {
    let folder = runs(40, 2);
    let at = folder.path();
    fs::write(at.join("broken.csv"), "nonsense\n").unwrap();
    let run = |arguments: &[&str]| {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = Command::new(cargo_bin("roadgrade"));
        command.args(arguments).current_dir(at).stderr(writer);
        command.status().unwrap().code()
    };
    assert_eq!(
        run(&["fuse", "--out", "map.csv", "0.csv", "1.csv"]),
        Some(0)
    );
    assert!(at.join("map.csv").exists());
    assert_eq!(run(&["export", "map.csv", "--out", "map.geojson"]), Some(0));
    assert_eq!(run(&["fuse", "--out", "no.csv", "broken.csv"]), Some(1));
}

#[test]
fn escapes_in_names_do_not_reach_the_terminal() {
    let folder = runs(40, 2);
    let at = folder.path();
    fs::create_dir(at.join("runs")).unwrap();
    let name = "\u{1b}]0;owned\u{7}\u{9b}31m\nroadgrade: all is well";
    fs::rename(
        at.join("0.csv"),
        at.join("runs").join(format!("{name}.csv")),
    )
    .unwrap();
    fs::rename(at.join("1.csv"), at.join("runs/1.csv")).unwrap();
    fs::write(at.join("runs").join(format!("{name}b.csv")), "nonsense\n").unwrap();
    fs::write(at.join("runs").join(format!(".{name}.csv")), "nonsense\n").unwrap();
    let message = done(at, &["fuse", "--out", "map.csv", "runs"]);
    let is_plain = |text: &str| !text.chars().any(|c| c.is_control() && c != '\n');
    assert!(is_plain(&message), "{message:?}");
    assert!(
        message.contains("\\u001b]0;owned\\u0007\\u009b31m"),
        "{message}"
    );
    assert!(
        !message
            .lines()
            .any(|line| line.starts_with("roadgrade: all is well")),
        "{message}"
    );
    // A log with such a name, on stdout: as text and as JSON.
    fs::write(at.join("d\u{1b}[31m.csv"), "time_s,wheel_speed_mps\n0,1\n").unwrap();
    for json in [&[][..], &["--json"]] {
        let mut command = Command::new(cargo_bin("roadgrade"));
        let output = command
            .current_dir(at)
            .args(["inspect", "d\u{1b}[31m.csv"])
            .args(json)
            .output();
        let output = output.unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && is_plain(&text), "{text:?}");
        if !json.is_empty() {
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert_eq!(value["log"], "d\u{1b}[31m.csv");
        }
    }
}
