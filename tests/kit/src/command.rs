//! The program as a user runs it.

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use std::path::Path;
use tempfile::TempDir;

/// Returns the program `roadgrade`, built with the tests.
///
/// # Panics
/// When it is not built.
#[must_use]
pub fn program() -> Command {
    Command::cargo_bin("roadgrade").expect("built")
}

/// Runs `roadgrade` with these arguments in a folder.
pub fn roadgrade(folder: &Path, arguments: &[&str]) -> Assert {
    program().current_dir(folder).args(arguments).assert()
}

/// Returns an empty folder that ends with the test.
///
/// # Panics
/// When it cannot be made.
#[must_use]
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}
