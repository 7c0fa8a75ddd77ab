//! The piped output of `listen`.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay};
use crate::listener::until_silent;
use host_sim::files::run;
use host_sim::live::panel::header;
use std::fs::File;
use std::process::Command;
use std::thread;

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn piped_output_has_a_line_a_second_and_a_separate_summary() {
    let vcan = Vcan::new("rgpipe");
    let drive = VcanDrive::new("A", 300.0);
    let output = thread::scope(|scope| {
        let listening = scope.spawn(|| until_silent(&drive, vcan.0, "4").output().unwrap());
        replay(vcan.0, &drive.log(), &["--speed", "5"]);
        listening.join().unwrap()
    });
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(&*header()));
    let columns = header().split_whitespace().count();
    let lines: Vec<Vec<&str>> = lines
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert!(lines.len() >= 4);
    for line in &lines {
        assert_eq!(line.len(), columns, "{line:?}");
    }
    // Two seconds after the last frame the mode is silent.
    assert_eq!(lines.last().unwrap()[5], "silent");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("| traction scale, end"), "{said}");
    assert!(drive.file("live.csv").exists());
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_drive_whose_lines_cannot_be_written_ends_and_is_kept() {
    let vcan = Vcan::new("rgfull");
    let drive = VcanDrive::new("A", 300.0);
    let output = thread::scope(|scope| {
        // It starts before the listener, so that there is a run to keep when the first line fails.
        scope.spawn(|| replay(vcan.0, &drive.log(), &["--speed", "2"]));
        Command::new(env!("CARGO_BIN_EXE_roadgrade"))
            .args(["listen", "--json", "--can", vcan.0, "--vehicle"])
            .arg(drive.vehicle())
            .arg("--out")
            .arg(drive.file("live.csv"))
            .stdout(File::create("/dev/full").unwrap())
            .output()
            .unwrap()
    });
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("stdout: No space left"), "{said}");
    assert!(!run::read(&drive.file("live.csv")).unwrap().is_empty());
}
