//! The program `roadgrade` as a user runs it.

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use std::path::Path;
use tempfile::TempDir;

/// Returns the program `roadgrade`, built with the tests.
///
/// # Panics
/// Panics if it is not built.
#[must_use]
pub fn program() -> Command {
    Command::cargo_bin("roadgrade").expect("built")
}

/// Runs `roadgrade` with these arguments in a folder.
pub fn roadgrade(folder: &Path, arguments: &[&str]) -> Assert {
    program().current_dir(folder).args(arguments).assert()
}

/// Returns an empty temporary folder.
///
/// # Panics
/// Panics if it cannot be created.
#[must_use]
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}
