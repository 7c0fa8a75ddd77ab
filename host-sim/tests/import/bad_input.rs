//! Unusable files. They are reported with file and line, and nothing is written.

use crate::import;
use crate::mission_maker::{HEADER, MissionMaker};
use predicates::prelude::*;
use std::fs;
use test_kit::command::program;

/// Checks that the import fails with status 1 and this message, and writes nothing.
fn refused(text: impl AsRef<[u8]>, message: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mission.csv");
    let out = folder.path().join("out");
    fs::write(&file, text).unwrap();
    let mut run = import(&file, &out).assert().code(1);
    for part in message {
        run = run.stderr(predicate::str::contains(*part));
    }
    run.stdout("");
    assert!(!out.exists(), "output of an import that failed");
}

/// Returns a short mission with line `line` changed by `change`.
fn damaged(line: usize, change: impl Fn(&str) -> String) -> String {
    let text = MissionMaker::new((0.0, 0.0), 3)
        .wait(10, 0)
        .drive(&[(900.0, 300.0)])
        .text();
    let lines = text.lines().zip(1..);
    lines
        .map(|(content, number)| {
            if number == line {
                change(content) + "\n"
            } else {
                format!("{content}\n")
            }
        })
        .collect()
}

#[test]
fn other_files_are_refused() {
    refused("", &["mission.csv:1", "no column time_unix"]);
    refused("a,b\n1,2\n", &["mission.csv:1", "odometry_vehicleSpeed"]);
    refused(
        damaged(1, |header| {
            header.replace("traction_brakePressure", "brake")
        }),
        &["mission.csv:1", "no column traction_brakePressure"],
    );
    refused([0xff_u8, 0xfe, 0x00, b',', b'\n'], &["mission.csv:1"]);
    refused(
        format!("{HEADER}\n"),
        &["mission.csv", "gnss_latitude", "expected"],
    );
}

#[test]
fn a_missing_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    import(&folder.path().join("nowhere.csv"), folder.path())
        .assert()
        .code(1)
        .stderr(predicate::str::contains("nowhere.csv"));
}

#[test]
fn truncated_lines_are_refused() {
    refused(
        damaged(9, |line| line[..line.len() / 2].to_owned()),
        &["mission.csv:9", "fields", "expected 16"],
    );
    let whole = damaged(0, str::to_owned);
    let cut = whole.trim_end().rfind(',').unwrap() - 3;
    refused(&whole[..cut], &["mission.csv:", "expected 16"]);
}

#[test]
fn text_in_place_of_numbers_is_refused() {
    for (bad, column) in [
        ("2500.5", "traction_tractionForce"),
        ("295.15", "temperature_ambient"),
    ] {
        for replacement in ["fast", "inf", "", "1e999", "0x10"] {
            refused(
                damaged(14, |line| line.replace(bad, replacement)),
                &["mission.csv:14", column, "expected a number"],
            );
        }
    }
}

#[test]
fn positions_in_degrees_are_refused() {
    refused(
        damaged(14, |line| line.replace(",0.82", ",47.32")),
        &["mission.csv:14", "gnss_latitude", "rad"],
    );
}

#[test]
fn time_that_stands_or_goes_back_is_refused() {
    for time in ["1600000005", "1600000010", "1599999999"] {
        refused(
            damaged(13, |line| line.replace("1600000011", time)),
            &["mission.csv:13", "time_unix does not increase"],
        );
    }
}

#[test]
fn a_mission_without_gnss_is_refused() {
    let text = MissionMaker::new((0.0, 0.0), u32::MAX)
        .wait(10, 0)
        .drive(&[(900.0, 300.0)])
        .text();
    refused(text, &["mission.csv", "expected a mission with GNSS"]);
}

#[test]
fn wrong_usage_ends_with_2() {
    let mut command = program();
    command.args(["import", "ztbus", "x.csv"]).assert().code(2);
}
