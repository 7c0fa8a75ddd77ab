//! Runs the program with limits.

use assert_cmd::cargo::cargo_bin;
use host_sim::files::run::{self, Origin, RunRow};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use test_kit::roads::{hills, run as run_over};

/// Memory that a command may use, bytes.
pub const MEMORY_BYTES: u64 = 512 << 20;

/// Runs the program in a folder with at most 60 s (exit status 124 after them: it hangs) and 512 MB.
pub fn limited(folder: &Path, arguments: &[&str]) -> Output {
    with_limit(folder, &format!("--as={MEMORY_BYTES}"), arguments)
}

/// Runs the program in a folder with a limit of `prlimit`.
pub fn with_limit(folder: &Path, limit: &str, arguments: &[&str]) -> Output {
    Command::new("prlimit")
        .args([limit, "timeout", "-k", "1", "60"])
        .arg(cargo_bin("roadgrade"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("prlimit and timeout, of util-linux and coreutils")
}

/// Returns what a command printed on stderr.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program and returns its messages; it must end with 1 within 60 s and 512 MB.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = limited(folder, arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {text}");
    assert!(!text.contains("panicked"), "{text}");
    text
}

/// Runs the program and returns its messages; it must end with 0 within 60 s and 512 MB.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = limited(folder, arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {text}");
    text
}

/// Returns a run over the first `cells` cells of the hills.
pub fn rows(cells: usize, number: usize) -> Vec<RunRow> {
    let mut rows = run_over(&hills()[..cells]);
    for row in &mut rows {
        row.grade_percent += 0.01 * number as f64;
    }
    rows
}

/// Returns a folder with the runs 0.csv, 1.csv, ….
pub fn runs(cells: usize, count: usize) -> TempDir {
    let folder = TempDir::new().expect("a folder");
    for number in 0..count {
        let path = folder.path().join(format!("{number}.csv"));
        run::write(&path, &rows(cells, number)).expect("written");
    }
    folder
}

/// Writes a run of a vehicle and a day as Parquet.
pub fn write_parquet(path: &Path, vehicle: &str, number: usize) {
    let origin = Origin {
        vehicle: Some(vehicle.to_owned()),
        day: Some("2026-11-21".to_owned()),
        ..Origin::default()
    };
    run::write_from(path, &rows(400, number), &origin).expect("written");
}

/// Returns the names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("listed");
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry.expect("an entry")))
        .collect();
    names.sort();
    names
}
