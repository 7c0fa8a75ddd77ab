//! can-utils on the same bus.

use crate::bus::{PATIENCE, Vcan, wait_until};
use crate::drive::{VcanDrive, frames_of, replay, untimed};
use crate::listener::Listener;
use embedded_can::Frame;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A process that is killed when the value is dropped.
pub struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts `candump -L` with a filter, or without one if it is empty. Its output goes to a file.
pub fn candump(vcan: &Vcan, filter: &str, to: &Path) -> Running {
    let child = Command::new("candump")
        .arg("-L")
        .arg(format!("{}{filter}", vcan.0))
        .stdin(Stdio::null())
        .stdout(File::create(to).unwrap())
        .spawn()
        .unwrap();
    vcan.wait_for_candump();
    Running(child)
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn candump_records_a_replay_that_estimate_reads() {
    let vcan = Vcan::new("rgdump");
    let drive = VcanDrive::new("A", 300.0);
    let recording = drive.file("candump.log");
    let candump = candump(&vcan, "", &recording);
    replay(vcan.0, &drive.log(), &["--speed", "2"]);
    let lines = || std::fs::read_to_string(&recording).unwrap().lines().count();
    wait_until("candump has all", || lines() == drive.frames.len());
    drop(candump);
    assert_eq!(frames_of(&recording), untimed(&drive.frames));
    assert!(drive.estimate(&recording).lines().count() > 10);
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn canplayer_feeds_a_listener_and_cangen_does_not_disturb_it() {
    let vcan = Vcan::new("rgplay");
    let drive = VcanDrive::new("A", 300.0);
    let listener = Listener::start(
        &drive,
        &[vcan.0],
        &["--out", "live.csv", "--log", "output.log"],
    );
    // 11-bit identifiers of any length, every millisecond.
    let cangen = Command::new("cangen")
        .args([vcan.0, "-g", "1"])
        .spawn()
        .unwrap();
    let cangen = Running(cangen);
    let status = Command::new("canplayer")
        .arg("-I")
        .arg(drive.log())
        .arg(format!("{}=can0", vcan.0))
        .stdin(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success(), "{status} within {PATIENCE:?}");
    drop(cangen);
    listener.signal("INT");
    let output = listener.finish();
    assert_eq!(output.lost(0), 0);
    // The listener takes the identifiers of OBD-II answers too, and cangen sends all of 11 bits.
    let mut recorded = frames_of(&drive.file("output.log"));
    recorded.retain(Frame::is_extended);
    assert_eq!(recorded, untimed(&drive.frames));
    assert_eq!(
        drive.estimate(&drive.file("output.log")),
        drive.read("live.csv")
    );
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn estimate_reads_a_recording_of_two_senders() {
    let vcan = Vcan::new("rgboth");
    let drive = VcanDrive::new("A", 300.0);
    let recording = drive.file("candump.log");
    let candump = candump(&vcan, "", &recording);
    let options = ["--publish", "--out", "live.csv"];
    let listener = Listener::start(&drive, &[vcan.0], &options);
    replay(vcan.0, &drive.log(), &["--speed", "2"]);
    listener.signal("INT");
    let output = listener.finish();
    assert_eq!(output.frames(0), drive.frames.len() as u64);
    let lines = || std::fs::read_to_string(&recording).unwrap().lines().count();
    wait_until("candump has the drive and the estimate", || {
        lines() > drive.frames.len() + 10
    });
    drop(candump);
    // The last line of candump may be incomplete.
    let text = std::fs::read_to_string(&recording).unwrap();
    let whole = text.rsplit_once('\n').unwrap().0.to_owned() + "\n";
    std::fs::write(&recording, whole).unwrap();
    assert!(drive.estimate(&recording).lines().count() > 10);
}
