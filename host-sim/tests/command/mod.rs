//! The program as a user runs it.

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use std::path::Path;

/// Runs `roadgrade` with these arguments in a folder.
pub fn roadgrade(folder: &Path, arguments: &[&str]) -> Assert {
    Command::cargo_bin("roadgrade")
        .expect("built")
        .current_dir(folder)
        .args(arguments)
        .assert()
}
