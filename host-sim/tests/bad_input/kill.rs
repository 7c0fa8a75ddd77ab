//! Kills and delays of the program at its system calls, by strace.

use crate::shell::names;
use assert_cmd::cargo::cargo_bin;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// System calls that change files.
pub const CALLS: [&str; 8] = [
    "openat",
    "write",
    "fsync",
    "link",
    "linkat",
    "rename",
    "renameat2",
    "unlink",
];

/// Returns true if there is a strace on this machine.
pub fn has_strace() -> bool {
    Command::new("strace").arg("-V").output().is_ok()
}

/// Returns the program under strace, with something injected into its system calls.
pub fn strace(at: &Path, injected: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("strace");
    command
        .args(["-f", "-o", "/dev/null", "-e"])
        .arg(format!("inject={injected}"))
        .arg(cargo_bin("roadgrade"))
        .args(arguments)
        .current_dir(at)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// Kills the program at its first call of a kind, at its second, and so on until it comes to its
/// end. After each kill `check` looks at the folder, and sets it back. Returns the number of kills.
pub fn kill_each(
    call: &str,
    folder: &TempDir,
    arguments: &[&str],
    mut check: impl FnMut(&Path),
) -> usize {
    let at = folder.path();
    for number in 1.. {
        let injected = format!("{call}:signal=KILL:when={number}");
        let status = strace(at, &injected, arguments).status().unwrap();
        check(at);
        let left: Vec<String> = names(at)
            .into_iter()
            .filter(|name| name.starts_with('.'))
            .collect();
        assert!(left.is_empty(), "{call} {number}: {left:?}");
        if status.success() {
            return number - 1;
        }
        let is_killed = status.signal() == Some(9) || status.code() == Some(137);
        assert!(is_killed, "{call} {number}: {status}");
    }
    unreachable!("the loop has no other end")
}
