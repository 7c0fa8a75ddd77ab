//! What stands in folders of runs: pipes, loops of links, hidden names, leftovers.

use crate::shell::{done, names, refused, rows, runs};
use assert_cmd::cargo::cargo_bin;
use host_sim::files::run;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn pipes_and_loops_of_links_are_named_and_left_out() {
    let folder = runs(40, 1);
    let at = folder.path();
    let runs = at.join("runs");
    fs::create_dir_all(runs.join("deep/deeper")).unwrap();
    fs::rename(at.join("0.csv"), runs.join("0.csv")).unwrap();
    for pipe in ["runs/pipe.csv", "runs/pipe.parquet"] {
        assert!(
            Command::new("mkfifo")
                .arg(at.join(pipe))
                .status()
                .unwrap()
                .success()
        );
    }
    for (number, link) in ["runs/deep/up", "runs/deep/deeper/up", "runs/deep/top"]
        .iter()
        .enumerate()
    {
        symlink(&runs, at.join(link)).unwrap();
        symlink("..", runs.join(format!("deep/deeper/loop{number}"))).unwrap();
    }
    symlink("nowhere.csv", runs.join("gone.csv")).unwrap();
    symlink("nowhere", runs.join("gone")).unwrap();
    let message = done(at, &["fuse", "--out", "map.csv", "runs"]);
    for left_out in [
        "runs/pipe.csv: a pipe or a device; expected a file: left out",
        "runs/pipe.parquet: a pipe or a device; expected a file: left out",
        "runs/deep/up: a link back to runs; expected folders without a loop: left out",
        "runs/gone.csv: ",
    ] {
        assert!(message.contains(left_out), "{left_out}: {message}");
    }
    refused(at, &["fuse", "--strict", "--out", "strict.csv", "runs"]);
    let message = refused(at, &["fuse", "--out", "strict.csv", "runs/pipe.csv"]);
    assert!(message.contains("a pipe or a device"), "{message}");
    assert!(!at.join("strict.csv").exists());
}

#[test]
fn hidden_names_are_counted_and_named() {
    let folder = runs(40, 1);
    let at = folder.path();
    fs::create_dir_all(at.join("runs/_temporary")).unwrap();
    fs::rename(at.join("0.csv"), at.join("runs/0.csv")).unwrap();
    for name in [
        ".a.csv",
        "_SUCCESS",
        ".b.parquet",
        ".roadgrade-abc.tmp",
        ".sums.csv.lock",
    ] {
        fs::write(at.join("runs").join(name), "").unwrap();
    }
    let message = done(at, &["fuse", "--out", "map.csv", "runs"]);
    let expected = "runs: 4 skipped, since the name begins with . or _: runs/.a.csv, \
                    runs/.b.parquet, runs/_SUCCESS, …";
    assert!(message.contains(expected), "{message}");
}

/// Starts a simulation of a long log, and returns when its temporary files are there.
fn simulating(at: &Path) -> std::process::Child {
    let scenario = "[road]\nlength_m = 200000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(at.join("s.toml"), scenario).unwrap();
    // A job in the background ignores SIGINT, and so would its children.
    let mut child = Command::new("env")
        .arg("--default-signal")
        .arg(cargo_bin("roadgrade"))
        .args(["simulate", "--scenario", "s.toml", "--out", "out"])
        .current_dir(at)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !at.join("out").exists() || names(&at.join("out")).is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it ended too early");
        assert!(begun.elapsed() < Duration::from_secs(60));
        std::thread::yield_now();
    }
    child
}

#[test]
fn signals_leave_no_temporary_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let mut child = simulating(at);
        kill(Pid::from_raw(child.id() as i32), signal).unwrap();
        let status = child.wait().unwrap();
        assert!(!status.success(), "{signal}");
        assert!(
            names(&at.join("out")).is_empty(),
            "{signal}: {:?}",
            names(&at.join("out"))
        );
        fs::remove_dir(at.join("out")).unwrap();
    }
    // A killed program cannot remove its files. They are no runs, and the next program removes them.
    let mut child = simulating(at);
    child.kill().unwrap();
    child.wait().unwrap();
    let left = names(&at.join("out"));
    let [left] = &left[..] else {
        panic!("{left:?}")
    };
    assert!(
        left.starts_with(".roadgrade-") && left.ends_with(".tmp"),
        "{left}"
    );
    run::write(&at.join("out/run.csv"), &rows(40, 0)).unwrap();
    let message = done(at, &["fuse", "--out", "out/map.csv", "out/run.csv"]);
    assert!(!message.contains(left), "{message}");
    assert_eq!(names(&at.join("out")), ["map.csv", "run.csv"]);
}

#[test]
fn what_another_program_is_writing_stays() {
    let folder = runs(40, 1);
    let at = folder.path();
    let mut child = simulating(at);
    let writing = names(&at.join("out"));
    done(at, &["fuse", "--out", "out/map.csv", "0.csv"]);
    if child.try_wait().unwrap().is_none() {
        let still = names(&at.join("out"));
        assert!(
            writing.iter().all(|name| still.contains(name)),
            "{writing:?} {still:?}"
        );
    }
    let _ = kill(Pid::from_raw(child.id() as i32), Signal::SIGTERM);
    child.wait().unwrap();
}
