//! `roadgrade replay` and `listen`: wrong usage, and the advice for a missing interface.

#![cfg(target_os = "linux")]

use assert_cmd::assert::Assert;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;
use test_kit::command::roadgrade;

const LOG: &str = "(1.000000) can0 0CF00400#0102030405060708\n";
/// A name that no interface has, since it is too long.
const NO_INTERFACE: &str = "no-such-interface";

struct Files {
    folder: TempDir,
}

impl Files {
    fn new() -> Self {
        let files = Self {
            folder: TempDir::new().unwrap(),
        };
        fs::write(files.path("drive.log"), LOG).unwrap();
        fs::write(files.path("table.csv"), "time_s,wheel_speed_mps\n0,1\n").unwrap();
        fs::write(
            files.path("vehicle.toml"),
            include_str!("../../vehicles/ztbus_lightram.toml"),
        )
        .unwrap();
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Assert {
        roadgrade(self.folder.path(), arguments)
    }
}

#[test]
fn wrong_usage_is_reported() {
    let files = Files::new();
    let listen = ["listen", "--can", "vcan0", "--vehicle", "vehicle.toml"];
    let with = |more: &[&'static str]| [&listen[..], more].concat();
    for (arguments, words) in [
        (vec!["listen", "--vehicle", "vehicle.toml"], "--can"),
        (vec!["listen", "--can", "vcan0"], "--vehicle"),
        (with(&["--can", "vcan0"]), "named twice"),
        (
            with(&["--can", "vcan1", "--log-time"]),
            "several interfaces",
        ),
        (with(&["--publish", "--address", "255"]), "0..=254"),
        (with(&["--address", "3"]), "--publish"),
        (with(&["--end-after-silence", "0"]), "greater than 0"),
        (with(&["--end-after-silence", "1e99"]), "greater than 0"),
        (vec!["replay", "drive.log"], "--can"),
        (vec!["replay", "--can", "vcan0"], "LOG"),
        (
            vec!["replay", "--can", "vcan0", "--speed", "0", "drive.log"],
            "or max",
        ),
        (
            vec!["replay", "--can", "vcan0", "--speed", "NaN", "drive.log"],
            "or max",
        ),
        (
            vec!["replay", "--can", "vcan0", "--speed", "fast", "drive.log"],
            "or max",
        ),
    ] {
        files.run(&arguments).code(2).stderr(contains(words));
    }
}

#[test]
fn unusable_files_are_named() {
    let files = Files::new();
    for (arguments, words) in [
        (
            vec!["listen", "--can", "a", "--vehicle", "none.toml"],
            "none.toml: No such file",
        ),
        (
            vec!["replay", "--can", "a", "table.csv"],
            "table.csv: is a signal table; expected a candump log",
        ),
        (
            vec!["replay", "--can", "a", "none.log"],
            "none.log: No such file",
        ),
    ] {
        files.run(&arguments).code(1).stderr(contains(words));
    }
}

#[test]
fn a_missing_interface_is_reported_with_the_command_that_adds_it() {
    let files = Files::new();
    let command = format!("ip link add dev {NO_INTERFACE} type vcan");
    let listen = [
        "listen",
        "--can",
        NO_INTERFACE,
        "--vehicle",
        "vehicle.toml",
        "--out",
        "run.csv",
    ];
    let replay = ["replay", "--can", NO_INTERFACE, "drive.log"];
    for arguments in [&listen[..], &replay] {
        files.run(arguments).code(1).stderr(contains(&command));
    }
    assert!(!files.path("run.csv").exists());
}

#[test]
fn an_interface_that_is_not_a_can_interface_is_reported() {
    let files = Files::new();
    let vehicle = ["--vehicle", "vehicle.toml"];
    // Every machine has a loopback interface. Without CAN in the kernel, that is the reason.
    let words = || contains("no CAN interface of this name").or(contains("this kernel has no CAN"));
    files
        .run(&[&["listen", "--can", "lo"], &vehicle[..]].concat())
        .code(1)
        .stderr(words());
    files
        .run(&["replay", "--can", "lo", "drive.log"])
        .code(1)
        .stderr(words());
}
