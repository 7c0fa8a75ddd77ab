//! The cells from an interface are those from the file.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay, write_log};
use crate::listener::Listener;
use std::thread;

const LOG_TIME: [&str; 3] = ["--log-time", "--out", "live.csv"];
const AT_ONCE: [&str; 3] = ["--log-time", "--speed", "max"];

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn ten_times_in_a_row_the_cells_are_equal_to_the_last_digit() {
    let vcan = Vcan::new("rgsame");
    let drive = VcanDrive::new("A", 1_000.0);
    let from_file = drive.estimate(&drive.log());
    assert!(from_file.lines().count() > 350);
    for time in 1..=10 {
        let listener = Listener::start(&drive, &[vcan.0], &LOG_TIME);
        let sent = replay(vcan.0, &drive.log(), &AT_ONCE);
        let output = listener.finish();
        assert_eq!(output.lost(0), 0, "time {time}");
        assert_eq!(output.frames(0), drive.frames.len() as u64, "time {time}");
        assert_eq!(drive.read("live.csv"), from_file, "time {time}");
        println!(
            "time {time}: {:.0} frames/s",
            sent["frames_per_s"].as_f64().unwrap()
        );
    }
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn two_vehicles_on_two_interfaces_do_not_disturb_each_other() {
    let buses = [Vcan::new("rgtwo0"), Vcan::new("rgtwo1")];
    let drives = [VcanDrive::new("A", 1_000.0), VcanDrive::new("B", 1_000.0)];
    thread::scope(|scope| {
        for (vcan, drive) in buses.iter().zip(&drives) {
            scope.spawn(move || {
                let listener = Listener::start(drive, &[vcan.0], &LOG_TIME);
                replay(vcan.0, &drive.log(), &AT_ONCE);
                let output = listener.finish();
                assert_eq!(output.lost(0), 0);
                assert_eq!(drive.read("live.csv"), drive.estimate(&drive.log()));
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
    assert_eq!(
        drive.estimate(&drive.file("output.log")),
        drive.read("live.csv")
    );
    assert_eq!(output.counted("altitudes left out"), 0);
}
