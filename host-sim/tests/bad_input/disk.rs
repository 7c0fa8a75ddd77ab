//! Disks that are full or slow, and kills, in every command that writes.

use crate::generated::good;
use crate::kill::{CALLS, has_strace, kill_each};
use crate::shell::{done, limited, names, stderr, with_limit};
use estimator_core::PersistentState;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::Duration;

/// Commands over the good files of the generated inputs; what they write is in `out`.
const COMMANDS: [&str; 15] = [
    "fuse --out out/m.csv --store out/s.csv run.csv",
    "fuse --out out/m.parquet --placed out/placed run.csv",
    "place --road line.csv --out out run.csv",
    "score --truth a.truth.csv --out out/s.csv a.csv",
    "export map.csv --out out/m.geojson",
    "export map.csv --out out/m.html",
    "export map_net.csv --out out/ways",
    "simulate --scenario scenario.toml --out out",
    "estimate --vehicle force.toml --out out/r.csv table.csv",
    "estimate --vehicle force.toml --out out/r.parquet --kept out/kept long_table.csv",
    "estimate --vehicle a.vehicle.toml --dataset out --day 2026-11-21 drive.log",
    "diagnose --vehicle force.toml --out out table.csv other.csv",
    "import ztbus mission.csv --out out",
    "demo --out out",
    "study ztbus --data data --out out",
];

fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let found = walkdir::WalkDir::new(folder).into_iter().flatten();
    let files = found.filter(|entry| entry.file_type().is_file());
    files
        .map(|entry| (entry.path().to_owned(), fs::read(entry.path()).unwrap()))
        .collect()
}

#[test]
fn a_full_disk_leaves_whole_files_or_none() {
    let folder = good::files();
    let at = folder.path();
    let out = at.join("out");
    for command in COMMANDS {
        let words: Vec<&str> = command.split(' ').collect();
        fs::create_dir_all(&out).unwrap();
        done(at, &words);
        let whole = contents(&out);
        assert!(!whole.is_empty(), "{command}");
        let sizes: Vec<usize> = whole.values().map(Vec::len).collect();
        let (least, most) = (sizes.iter().min().unwrap(), sizes.iter().max().unwrap());
        for limit in [0, 1, least - 1, most / 2, most - 1] {
            fs::remove_dir_all(&out).unwrap();
            fs::create_dir_all(&out).unwrap();
            let output = with_limit(at, &format!("--fsize={limit}"), &words);
            let message = stderr(&output);
            assert_eq!(
                output.status.code(),
                Some(1),
                "{command}, {limit}: {message}"
            );
            assert!(
                message.contains("File too large"),
                "{command}, {limit}: {message}"
            );
            for (path, content) in contents(&out) {
                assert!(
                    whole.get(&path) == Some(&content),
                    "{command}, {limit}: {} is not whole",
                    path.display()
                );
            }
        }
        fs::remove_dir_all(&out).unwrap();
        assert!(!names(at).iter().any(|name| name.starts_with('.')));
    }
}

#[test]
fn a_kill_leaves_the_old_state_of_a_vehicle_or_the_new_one() {
    if !has_strace() {
        eprintln!("SKIPPED a kill at any change of a file: no strace");
        return;
    }
    let folder = good::files();
    let at = folder.path();
    let before = fs::read(at.join("kept")).unwrap();
    let words: Vec<&str> = "estimate --vehicle force.toml --kept kept --out r.csv long_table.csv"
        .split(' ')
        .collect();
    done(at, &words);
    let (after, run) = (
        fs::read(at.join("kept")).unwrap(),
        fs::read(at.join("r.csv")).unwrap(),
    );
    assert!(before != after);
    let (mut kills, mut old, mut new) = (0, 0, 0);
    // Of the many writes of the run file only those of a short one.
    for call in CALLS.into_iter().filter(|call| *call != "write") {
        fs::write(at.join("kept"), &before).unwrap();
        let _ = fs::remove_file(at.join("r.csv"));
        kills += kill_each(call, &folder, &words, |at| {
            let kept = fs::read(at.join("kept")).unwrap();
            PersistentState::from_bytes(&kept).unwrap();
            match kept == before {
                true => old += 1,
                false => {
                    assert!(kept == after);
                    new += 1;
                }
            }
            if let Ok(found) = fs::read(at.join("r.csv")) {
                assert!(found == run, "half a run");
                fs::remove_file(at.join("r.csv")).unwrap();
            }
            fs::write(at.join("kept"), &before).unwrap();
            // The next program removes what the killed one left.
            done(at, &["fuse", "--out", "map.csv", "run.csv"]);
        });
    }
    eprintln!("{kills} kills: {old} times the old state, {new} times the new one");
    assert!(kills > 5 && old > 5 && new > 1, "{kills} {old} {new}");
}

#[test]
fn a_slow_reader_gets_the_whole_map() {
    let folder = good::files();
    let at = folder.path();
    done(at, &["fuse", "--out", "whole.csv", "run.csv"]);
    let pipe = at.join("pipe.csv");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let read = thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut text = Vec::new();
            let mut file = fs::File::open(&pipe).unwrap();
            let mut part = [0; 256];
            while let Ok(count @ 1..) = file.read(&mut part) {
                text.extend_from_slice(&part[..count]);
                thread::sleep(Duration::from_millis(5));
            }
            text
        });
        let output = limited(at, &["fuse", "--out", "pipe.csv", "run.csv"]);
        if !output.status.success() {
            // Lets the reader come to its end.
            let _ = fs::OpenOptions::new().read(true).write(true).open(&pipe);
        }
        assert!(output.status.success(), "{}", stderr(&output));
        reader.join().unwrap()
    });
    assert!(read == fs::read(at.join("whole.csv")).unwrap());
}
