//! The files of a simulated drive.

use crate::roadgrade;
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::simulate;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use host_sim::source::frame_log::FrameLog;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A drive, its log and its vehicle.
pub struct VcanDrive {
    folder: TempDir,
    pub frames: Vec<TimedFrame>,
}

impl VcanDrive {
    /// Simulates a drive of this length by truck A or B.
    pub fn new(truck: &str, length_m: f64) -> Self {
        let text = format!(
            "seed = 7\n[road]\nlength_m = {length_m}\n[[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n"
        );
        let scenario = Scenario::parse(&text, Path::new("a drive")).unwrap();
        let run = simulate(&scenario, 0).unwrap();
        let folder = TempDir::new().unwrap();
        run.vehicle
            .write(&folder.path().join("vehicle.toml"))
            .unwrap();
        let drive = Self {
            folder,
            frames: run.frames,
        };
        write_log(&drive.file("drive.log"), &drive.frames);
        drive
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn log(&self) -> PathBuf {
        self.file("drive.log")
    }

    pub fn vehicle(&self) -> PathBuf {
        self.file("vehicle.toml")
    }

    /// Runs `roadgrade estimate` on a log and returns the text of the run file.
    pub fn estimate(&self, log: &Path) -> String {
        self.estimate_with(log, &[])
    }

    /// Does the same with more options.
    pub fn estimate_with(&self, log: &Path, options: &[&str]) -> String {
        let out = self.file("estimated.csv");
        roadgrade()
            .args(["estimate", "--vehicle"])
            .arg(self.vehicle())
            .arg("--out")
            .arg(&out)
            .args(options)
            .arg(log)
            .assert()
            .success();
        fs::read_to_string(out).unwrap()
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.file(name)).unwrap()
    }
}

pub fn write_log(path: &Path, frames: &[TimedFrame]) {
    let mut out = BufWriter::new(File::create(path).unwrap());
    for frame in frames {
        write_frame(&mut out, frame, "can0").unwrap();
    }
    out.flush().unwrap();
}

/// Returns the frames of a log without their times.
pub fn frames_of(path: &Path) -> Vec<CanFrame> {
    let log = FrameLog::open_candump(path).unwrap();
    log.map(|timed| timed.unwrap().frame).collect()
}

/// Returns the frames of a drive without their times.
pub fn untimed(frames: &[TimedFrame]) -> Vec<CanFrame> {
    frames.iter().map(|timed| timed.frame).collect()
}

/// Replays a log. Returns the summary.
pub fn replay(interface: &str, log: &Path, options: &[&str]) -> serde_json::Value {
    let output = roadgrade()
        .args(["replay", "--json", "--can", interface])
        .args(options)
        .arg(log)
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{complaint}");
    serde_json::from_slice(&output.stdout).unwrap()
}
