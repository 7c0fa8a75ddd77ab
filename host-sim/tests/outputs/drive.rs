//! A short simulated drive, and the program run on it.

use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;
use test_kit::command::{folder, program};

/// Seconds that are added to the times of the log: 2026-01-02T03:04:00Z.
pub const START_S: f64 = 1_767_323_040.0;

/// Returns a folder with d.log, whose times are absolute, and v.toml.
pub fn drive() -> TempDir {
    let folder = folder();
    let at = folder.path();
    let scenario = "seed = 3\n[road]\nlength_m = 2000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(at.join("s.toml"), scenario).unwrap();
    done(at, &["simulate", "--scenario", "s.toml", "--out", "."]);
    let log = fs::read_to_string(at.join("a.log")).unwrap();
    let absolute = log.lines().map(|line| {
        let (time, rest) = line[1..].split_once(") ").unwrap();
        let seconds: f64 = time.parse().unwrap();
        format!("({:.6}) {rest}\n", START_S + seconds)
    });
    fs::write(at.join("d.log"), absolute.collect::<String>()).unwrap();
    fs::rename(at.join("a.vehicle.toml"), at.join("v.toml")).unwrap();
    folder
}

/// Runs the program in a folder.
pub fn run(at: &Path, arguments: &[&str]) -> Output {
    program().current_dir(at).args(arguments).output().unwrap()
}

/// Runs the program in a folder, which must succeed.
pub fn done(at: &Path, arguments: &[&str]) -> Output {
    let output = run(at, arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    output
}

/// Runs the program in a folder, which must end with this code. Returns what it says.
pub fn refused(at: &Path, code: i32, arguments: &[&str]) -> String {
    let output = run(at, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    message
}

/// Estimates the drive into a file.
pub fn estimate(at: &Path, out: &str) -> Output {
    done(
        at,
        &["estimate", "--vehicle", "v.toml", "--out", out, "d.log"],
    )
}
