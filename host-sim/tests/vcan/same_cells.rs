//! The cells from an interface are those from the file.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay, write_log};
use crate::listener::Listener;
use host_sim::files::run;
use std::{fs, thread};

const LOG_TIME: [&str; 3] = ["--log-time", "--out", "live.csv"];
const AT_ONCE: [&str; 3] = ["--log-time", "--speed", "max"];
/// Some 2,000 frames a second: a bus that is nearly full.
const FASTER: [&str; 3] = ["--log-time", "--speed", "6"];

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn ten_times_in_a_row_the_cells_are_equal_to_the_last_digit() {
    let vcan = Vcan::new("rgsame");
    let drive = VcanDrive::new("A", 500.0);
    let from_file = drive.estimate(&drive.log());
    assert!(from_file.lines().count() > 150);
    for time in 1..=10 {
        let listener = Listener::start(&drive, &[vcan.0], &LOG_TIME);
        let sent = replay(vcan.0, &drive.log(), &AT_ONCE);
        let output = listener.finish();
        assert_eq!(output.lost(0), 0, "time {time}");
        assert_eq!(output.frames(0), drive.frames.len() as u64, "time {time}");
        assert_same_lines(&drive.read("live.csv"), &from_file);
        println!(
            "time {time}: {:.0} frames/s",
            sent["frames_per_s"].as_f64().unwrap()
        );
    }
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_road_memory_learns_from_the_bus_what_it_learns_from_the_file() {
    let vcan = Vcan::new("rgmemory");
    // Longer than a minute: the memory is written once on the way, and at the end.
    let drive = VcanDrive::new("A", 1_500.0);
    let (of_file, of_bus) = (drive.file("file.memory"), drive.file("bus.memory"));
    let [of_file, of_bus] = [&of_file, &of_bus].map(|path| path.to_str().unwrap());
    for _ in 0..2 {
        let from_file = drive.estimate_with(&drive.log(), &["--memory", of_file]);
        let options = [&LOG_TIME[..], &["--memory", of_bus]].concat();
        let listener = Listener::start(&drive, &[vcan.0], &options);
        replay(vcan.0, &drive.log(), &FASTER);
        let output = listener.finish();
        assert_eq!(output.lost(0), 0);
        assert!(output.end["summary"]["memory"]["writes"].as_u64().unwrap() > 1);
        assert_same_lines(&drive.read("live.csv"), &from_file);
        assert!(fs::read(of_bus).unwrap() == fs::read(of_file).unwrap());
    }
    let rows = run::read(&drive.file("live.csv")).unwrap();
    assert!(rows.iter().any(|row| row.map_grade_percent.is_some()));
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn two_vehicles_on_two_interfaces_do_not_disturb_each_other() {
    let buses = [Vcan::new("rgtwo0"), Vcan::new("rgtwo1")];
    let drives = [VcanDrive::new("A", 500.0), VcanDrive::new("B", 500.0)];
    thread::scope(|scope| {
        for (vcan, drive) in buses.iter().zip(&drives) {
            scope.spawn(move || {
                let listener = Listener::start(drive, &[vcan.0], &LOG_TIME);
                replay(vcan.0, &drive.log(), &AT_ONCE);
                let output = listener.finish();
                assert_eq!(output.lost(0), 0);
                assert_same_lines(&drive.read("live.csv"), &drive.estimate(&drive.log()));
            });
        }
    });
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_vehicle_with_two_buses_is_estimated_from_both() {
    let buses = [Vcan::new("rgbus0"), Vcan::new("rgbus1")];
    let drive = VcanDrive::new("A", 300.0);
    // The GNSS receiver on a bus of its own: NMEA 2000 has parameter groups from 0x1F800.
    let is_gnss = |frame: &host_sim::source::can_frame::TimedFrame| {
        let embedded_can::Id::Extended(id) = embedded_can::Frame::id(&frame.frame) else {
            return false;
        };
        id.as_raw() >> 8 & 0x3_ffff >= 0x1_f800
    };
    let (gnss, truck): (Vec<_>, Vec<_>) = drive.frames.iter().partition(|frame| is_gnss(frame));
    let logs = [("truck.log", truck), ("gnss.log", gnss)];
    for (name, frames) in &logs {
        assert!(!frames.is_empty());
        write_log(&drive.file(name), frames);
    }
    let options = ["--out", "live.csv", "--log", "output.log"];
    let listener = Listener::start(&drive, &[buses[0].0, buses[1].0], &options);
    thread::scope(|scope| {
        for ((name, _), vcan) in logs.iter().zip(&buses) {
            let log = drive.file(name);
            scope.spawn(move || replay(vcan.0, &log, &["--speed", "2"]));
        }
    });
    listener.signal("INT");
    let output = listener.finish();
    assert_eq!(output.frames(0), logs[0].1.len() as u64);
    assert_eq!(output.frames(1), logs[1].1.len() as u64);
    // In the order of time, since the reader of the log refuses any other.
    assert_same_lines(
        &drive.estimate(&drive.file("output.log")),
        &drive.read("live.csv"),
    );
    assert_eq!(output.counted("altitudes left out"), 0);
}

/// Compares line by line: a message with two whole files takes the virtual machine minutes to print.
fn assert_same_lines(left: &str, right: &str) {
    for (number, (left, right)) in left.lines().zip(right.lines()).enumerate() {
        assert_eq!(left, right, "line {}", number + 1);
    }
    assert_eq!(left.lines().count(), right.lines().count());
}
