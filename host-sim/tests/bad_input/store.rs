//! The store: damage, two programs at once, the version before, and a kill at every moment.

use crate::kill::{CALLS, has_strace, kill_each, strace};
use crate::shell::{done, names, refused, runs, stderr, with_limit, write_parquet};
use assert_cmd::cargo::cargo_bin;
use host_sim::files::parquet::{ParquetColumn, stage};
use host_sim::map::read_store;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

const FUSE: [&str; 5] = ["fuse", "--out", "map.csv", "--store", "sums.csv"];

fn fuse<'a>(runs: &[&'a str]) -> Vec<&'a str> {
    [&FUSE[..], runs].concat()
}

fn count_of_runs(folder: &Path) -> usize {
    read_store(&folder.join("sums.csv"))
        .expect("a store")
        .runs
        .len()
}

#[test]
fn every_flipped_bit_of_a_store_is_refused() {
    let folder = runs(9, 3);
    let at = folder.path();
    done(at, &fuse(&["0.csv", "--session", "day=1.csv,2.csv"]));
    let path = at.join("sums.csv");
    let good = fs::read(&path).unwrap();
    read_store(&path).unwrap();
    let mut accepted = Vec::new();
    // All of the first and the last line, and some of what is between.
    let bits = 8 * good.len();
    let outer = (0..800).chain(bits - 800..bits);
    for bit in outer.chain((800..bits - 800).step_by(13)) {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &bytes).unwrap();
        if read_store(&path).is_ok() {
            accepted.push(bit);
        }
    }
    assert!(accepted.is_empty(), "of {bits}: {accepted:?}");
    // Nor is one that is cut or longer.
    for bytes in [&good[..good.len() - 9], &[&good[..], b"x\n"].concat()] {
        fs::write(&path, bytes).unwrap();
        assert!(read_store(&path).is_err());
    }
}

#[test]
fn the_version_before_is_kept_and_named_where_a_store_is_damaged() {
    let folder = runs(9, 3);
    let at = folder.path();
    done(at, &fuse(&["0.csv"]));
    assert!(!at.join("sums.csv.previous").exists());
    let first = fs::read(at.join("sums.csv")).unwrap();
    done(at, &fuse(&["1.csv"]));
    assert_eq!(fs::read(at.join("sums.csv.previous")).unwrap(), first);
    let mut damaged = fs::read(at.join("sums.csv")).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(at.join("sums.csv"), &damaged).unwrap();
    let message = refused(at, &fuse(&["2.csv"]));
    assert!(
        message.contains("sums.csv.previous is the version before"),
        "{message}"
    );
    assert_eq!(fs::read(at.join("sums.csv")).unwrap(), damaged);
    // As the message says:
    fs::copy(at.join("sums.csv.previous"), at.join("sums.csv")).unwrap();
    done(at, &fuse(&["1.csv", "2.csv"]));
    assert_eq!(count_of_runs(at), 3);
}

#[test]
fn a_store_without_a_checksum_is_read_and_gets_one() {
    let folder = runs(9, 2);
    let at = folder.path();
    done(at, &fuse(&["0.csv"]));
    let text = fs::read_to_string(at.join("sums.csv")).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    let (counts, checksum) = first.split_once(", xxh3: ").unwrap();
    assert_eq!(checksum.len(), 32);
    fs::write(at.join("sums.csv"), format!("{counts}\n{rest}")).unwrap();
    let message = done(at, &fuse(&["1.csv"]));
    assert!(message.contains("written without a checksum"), "{message}");
    let text = fs::read_to_string(at.join("sums.csv")).unwrap();
    assert!(text.lines().next().unwrap().contains(", xxh3: "), "{text}");
    assert_eq!(count_of_runs(at), 2);
}

#[test]
fn two_fusions_at_once_both_count() {
    for _ in 0..12 {
        let folder = runs(100, 3);
        let at = folder.path();
        done(at, &fuse(&["0.csv"]));
        let children = ["1.csv", "2.csv"].map(|run| {
            Command::new(cargo_bin("roadgrade"))
                .args([
                    "fuse",
                    "--out",
                    &format!("map_{run}"),
                    "--store",
                    "sums.csv",
                    run,
                ])
                .current_dir(at)
                .stderr(Stdio::null())
                .spawn()
                .unwrap()
        });
        for mut child in children {
            assert!(child.wait().unwrap().success());
        }
        assert_eq!(count_of_runs(at), 3);
        assert!(!names(at).iter().any(|name| name.ends_with(".lock")));
    }
}

#[test]
fn names_of_vehicles_do_not_spoil_a_store() {
    for vehicle in [
        "A\tB",
        "A\nB",
        "A\r\n# run 1",
        "",
        " ",
        "\u{1b}[31m",
        "#",
        "a,\"b",
    ] {
        let folder = runs(400, 1);
        let at = folder.path();
        write_parquet(&at.join("a.parquet"), vehicle, 1);
        write_parquet(&at.join("b.parquet"), vehicle, 2);
        let message = done(at, &fuse(&["0.csv", "a.parquet"]));
        assert!(!message.contains('\u{1b}'), "{message:?}");
        done(at, &fuse(&["b.parquet"]));
        assert_eq!(count_of_runs(at), 3, "{vehicle:?}");
    }
}

/// A run whose metadata have this session, as another program may write it.
fn write_foreign(path: &Path, session: &str) {
    let rows = crate::shell::rows(400, 5);
    let column = |name, value: fn(&host_sim::files::run::RunRow) -> f64| {
        ParquetColumn::numbers(name, rows.iter().map(value))
    };
    let columns = vec![
        column("distance_m", |row| row.distance_m),
        column("latitude_deg", |row| row.latitude_deg.unwrap()),
        column("longitude_deg", |row| row.longitude_deg.unwrap()),
        column("altitude_m", |row| row.altitude_m.unwrap()),
        column("altitude_sigma_m", |row| row.altitude_sigma_m.unwrap()),
        column("grade_percent", |row| row.grade_percent),
        column("grade_sigma_percent", |row| row.grade_sigma_percent),
    ];
    let staged = stage(path, columns, &[("session", session.to_owned())]);
    staged.unwrap().commit().unwrap();
}

#[test]
fn sessions_without_a_name_of_other_programs_are_refused() {
    for session in ["", " ", "a\tb", "a\nb"] {
        let folder = runs(400, 1);
        let at = folder.path();
        fs::create_dir(at.join("runs")).unwrap();
        fs::rename(at.join("0.csv"), at.join("runs/0.csv")).unwrap();
        write_foreign(&at.join("runs/foreign.parquet"), session);
        let message = refused(at, &fuse(&["runs/foreign.parquet"]));
        assert!(
            message.contains("foreign.parquet: session name"),
            "{message}"
        );
        assert!(!at.join("sums.csv").exists() && !at.join("map.csv").exists());
        // In a folder it is left out, as any damaged file.
        let message = done(at, &fuse(&["runs"]));
        assert!(
            message.contains("foreign.parquet: session name"),
            "{message}"
        );
        done(at, &fuse(&["runs/0.csv"]));
        assert_eq!(count_of_runs(at), 1);
    }
}

#[test]
fn a_full_disk_leaves_the_store_as_it_was() {
    let folder = runs(400, 2);
    let at = folder.path();
    done(at, &fuse(&["0.csv"]));
    let before = fs::read(at.join("sums.csv")).unwrap();
    let size = before.len();
    for limit in [0, 1, 4096, size / 2, size - 1] {
        let output = with_limit(at, &format!("--fsize={limit}"), &fuse(&["1.csv"]));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{limit}: {message}");
        assert!(message.contains("File too large"), "{message}");
        assert_eq!(fs::read(at.join("sums.csv")).unwrap(), before);
        assert!(
            !names(at).iter().any(|name| name.starts_with('.')),
            "{:?}",
            names(at)
        );
    }
    let message = refused(at, &["fuse", "--out", "/dev/full", "1.csv"]);
    assert!(message.contains("/dev/full: No space left"), "{message}");
    assert_eq!(fs::metadata("/dev/full").unwrap().len(), 0);
}

#[test]
fn a_kill_at_any_change_of_a_file_leaves_the_old_store_or_the_new_one() {
    if !has_strace() {
        eprintln!("SKIPPED a kill at any change of a file: no strace");
        return;
    }
    let (mut kills, mut old, mut new) = (0, 0, 0);
    for call in CALLS {
        // A store of many blocks for the writes, a small one for all else.
        let folder = runs(if call == "write" { 600 } else { 9 }, 2);
        done(folder.path(), &fuse(&["0.csv"]));
        let before = fs::read(folder.path().join("sums.csv")).unwrap();
        let check = |at: &Path| {
            match count_of_runs(at) {
                1 => {
                    old += 1;
                    assert_eq!(fs::read(at.join("sums.csv")).unwrap(), before);
                }
                2 => new += 1,
                count => panic!("{count} runs"),
            }
            // The next run goes on, and removes what the killed one left.
            done(at, &fuse(&["1.csv"]));
            assert_eq!(count_of_runs(at), 2);
            for name in ["sums.csv.previous", "map.csv"] {
                let _ = fs::remove_file(at.join(name));
            }
            fs::write(at.join("sums.csv"), &before).unwrap();
        };
        kills += kill_each(call, &folder, &fuse(&["1.csv"]), check);
    }
    eprintln!("{kills} kills: {old} times the old store, {new} times the new one");
    assert!(kills > 30 && old > 20 && new > 1);
}

#[test]
fn a_store_on_a_slow_disk_is_at_any_moment_the_old_one_or_the_new_one() {
    if !has_strace() {
        eprintln!("SKIPPED a slow disk: no strace");
        return;
    }
    let folder = runs(600, 2);
    let at = folder.path();
    done(at, &fuse(&["0.csv"]));
    let mut child = strace(
        at,
        "write,fsync,rename,linkat:delay_enter=100000",
        &fuse(&["1.csv"]),
    )
    .spawn()
    .unwrap();
    let (mut old, mut new) = (0, 0);
    while child.try_wait().unwrap().is_none() {
        match count_of_runs(at) {
            1 => old += 1,
            _ => new += 1,
        }
    }
    assert!(child.wait().unwrap().success());
    assert_eq!(count_of_runs(at), 2);
    // The same bytes as on a fast disk.
    let slow = fs::read(at.join("sums.csv")).unwrap();
    fs::copy(at.join("sums.csv.previous"), at.join("sums.csv")).unwrap();
    done(at, &fuse(&["1.csv"]));
    assert!(fs::read(at.join("sums.csv")).unwrap() == slow);
    eprintln!("read {old} times before the new store appeared, {new} times after it");
    assert!(old > 10, "{old}");
}
