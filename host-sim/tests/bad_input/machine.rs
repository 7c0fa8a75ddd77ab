//! A machine at its limits.

use crate::shell::{done, runs, stderr, with_limit, write_parquet};
use std::fs;

#[test]
fn too_many_open_files_are_no_damage() {
    let folder = runs(40, 6);
    let at = folder.path();
    fs::create_dir(at.join("runs")).unwrap();
    for number in 0..6 {
        let name = format!("{number}.csv");
        fs::rename(at.join(&name), at.join("runs").join(&name)).unwrap();
    }
    for number in 0..6 {
        write_parquet(&at.join(format!("runs/{number}.parquet")), "A", number);
    }
    done(at, &["fuse", "--out", "map.csv", "runs"]);
    let whole = fs::read(at.join("map.csv")).unwrap();
    let mut refusals = 0;
    for limit in 5..20 {
        let _ = fs::remove_file(at.join("map.csv"));
        let arguments = ["fuse", "--out", "map.csv", "runs"];
        let output = with_limit(at, &format!("--nofile={limit}"), &arguments);
        let message = stderr(&output);
        if output.status.success() {
            assert_eq!(
                fs::read(at.join("map.csv")).unwrap(),
                whole,
                "{limit}: {message}"
            );
        } else {
            assert_eq!(output.status.code(), Some(1), "{limit}: {message}");
            assert!(!at.join("map.csv").exists());
            assert!(!message.contains("left out"), "{limit}: {message}");
            refusals += usize::from(message.contains("allow more open files (ulimit -n 4096)"));
        }
    }
    assert!(refusals > 0);
}
