//! Logs of several interfaces.

use predicates::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::program;

struct Drive {
    folder: TempDir,
    lines: Vec<String>,
}

impl Drive {
    fn new() -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let scenario = folder.path().join("scenario.toml");
        let text = "[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
        fs::write(&scenario, text).expect("a temporary file");
        let mut simulate = program();
        simulate.args(["simulate", "--scenario"]).arg(&scenario);
        simulate.arg("--out").arg(folder.path()).assert().success();
        let log = fs::read_to_string(folder.path().join("a.log")).expect("a log");
        let lines = log.lines().map(str::to_owned).collect();
        Self { folder, lines }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, text: &str) -> PathBuf {
        let path = self.path("changed.log");
        fs::write(&path, text).expect("a temporary file");
        path
    }

    fn cells(&self, log: &Path, options: &[&str]) -> Vec<u8> {
        let mut estimate = program();
        estimate.args(["estimate", "--vehicle"]);
        estimate.arg(self.path("a.vehicle.toml"));
        estimate.arg("--out").arg(self.path("run.csv"));
        estimate.args(options).arg(log).assert().success();
        fs::read(self.path("run.csv")).expect("a run")
    }

    fn doubled(&self, delay_us: u64) -> String {
        let twice = self.lines.iter().map(|line| {
            let other = delayed(line, delay_us).replace("can0", "can1");
            format!("{line}\n{other}\n")
        });
        twice.collect()
    }
}

/// Returns a line with a later time stamp.
fn delayed(line: &str, delay_us: u64) -> String {
    let (stamp, rest) = line.split_once(' ').expect("a time");
    let digits = stamp.replace(['(', ')', '.'], "");
    let micros = digits.parse::<u64>().expect("a time") + delay_us;
    format!("({}.{:06}) {rest}", micros / 1_000_000, micros % 1_000_000)
}

fn is_of_receiver(line: &str) -> bool {
    [
        "1F801", "1F802", "1F805", "1FA03", "F801", "F802", "F805", "FA03",
    ]
    .iter()
    .any(|pgn| {
        line.split(' ')
            .nth(2)
            .is_some_and(|frame| frame[..8].contains(pgn))
    })
}

#[test]
fn a_bus_that_is_heard_twice_gives_the_same_cells() {
    let drive = Drive::new();
    let expected = drive.cells(&drive.path("a.log"), &[]);
    for delay_us in [0, 137, 4_000] {
        let log = drive.write(&drive.doubled(delay_us));
        assert!(drive.cells(&log, &[]) == expected, "{delay_us} µs");
        assert!(drive.cells(&log, &["--interface", "can0"]) == expected);
    }
    let log = drive.write(&drive.doubled(0));
    assert!(drive.cells(&log, &["--interface", "can1"]) == expected);
    // The second interface begins later and ends earlier.
    let half = drive.lines.len() / 2;
    let parts = drive.lines.iter().enumerate().map(|(k, line)| {
        let twice = half / 2 < k && k < half;
        let other = line.replace("can0", "can1");
        if twice {
            format!("{line}\n{other}\n")
        } else {
            format!("{line}\n")
        }
    });
    let log = drive.write(&parts.collect::<String>());
    assert!(drive.cells(&log, &[]) == expected);
}

#[test]
fn two_buses_on_two_interfaces_are_one() {
    let drive = Drive::new();
    let expected = drive.cells(&drive.path("a.log"), &[]);
    let line = |line: &String| match is_of_receiver(line) {
        true => line.replace("can0", "can1") + "\n",
        false => line.to_owned() + "\n",
    };
    let text: String = drive.lines.iter().map(line).collect();
    assert!(text.contains("can1"));
    let log = drive.write(&text);
    assert!(drive.cells(&log, &[]) == expected);
    // A second receiver with the same address, whose fast packets begin between the others.
    let foreign = |line: &String| match is_of_receiver(line) {
        true => format!(
            "{line}\n{}\n",
            line.replace("can0", "can2")[..line.len() - 6].to_owned() + "123456"
        ),
        false => line.to_owned() + "\n",
    };
    let text: String = drive.lines.iter().map(foreign).collect();
    let log = drive.write(&text);
    assert!(drive.cells(&log, &[]) == expected);
}

#[test]
fn interfaces_are_shown_and_selected() {
    let drive = Drive::new();
    let log = drive.write(&drive.doubled(100));
    let inspect = |options: &[&str]| {
        let mut inspect = program();
        inspect.arg("inspect").args(options).arg(&log).assert()
    };
    let shown = predicate::str::is_match(r"\| can1 +\| +[0-9,]+ +\|").expect("a pattern");
    inspect(&[]).success().stdout(shown);
    let output = inspect(&["--json"]).success();
    let json: serde_json::Value =
        serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    let frames = drive.lines.len();
    assert_eq!(json["frames"], frames);
    for (k, name, duplicates) in [(0, "can0", 0), (1, "can1", frames)] {
        let found = &json["interfaces"][k];
        assert_eq!(found["name"], name);
        assert_eq!(
            (&found["frames"], &found["duplicates"]),
            (&frames.into(), &duplicates.into())
        );
    }
    let words = "no frames of interface can7; expected one of can0, can1";
    inspect(&["--interface", "can7"])
        .code(1)
        .stderr(predicate::str::contains(words));
}
