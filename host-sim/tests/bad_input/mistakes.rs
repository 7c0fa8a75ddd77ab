//! Mistakes of a newcomer: files in the wrong place, names of another format, columns misspelt.

use crate::shell::{done, limited, names, refused, runs, stderr};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const VEHICLE: &str = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
    rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
    [traction]\nsource = \"force\"\n";

/// Returns a folder with a file of each kind.
fn kinds() -> TempDir {
    let folder = runs(40, 1);
    let at = folder.path();
    fs::write(at.join("v.toml"), VEHICLE).unwrap();
    fs::write(at.join("t.csv"), "time_s,wheel_speed_mps\n0,1\n1,2\n").unwrap();
    fs::write(
        at.join("d.log"),
        "(1.000000) can0 0CF00400#0102030405060708\n",
    )
    .unwrap();
    fs::write(at.join("s.toml"), "[road]\n[[runs]]\nname = \"a\"\n").unwrap();
    fs::write(at.join("tuning.toml"), "[hold_times]\nhold_ms = 1500\n").unwrap();
    done(
        at,
        &["fuse", "--out", "map.csv", "--store", "sums.csv", "0.csv"],
    );
    done(at, &["fuse", "--out", "map.parquet", "0.csv"]);
    folder
}

/// Runs a command, given in one line, and checks its message.
fn says(at: &Path, command: &str, expected: &str) {
    let words: Vec<&str> = command.split(' ').collect();
    let message = refused(at, &words);
    assert!(message.contains(expected), "{command}: {message}");
    assert!(message.len() < 250, "{command}: {message}");
}

#[test]
fn a_file_in_the_wrong_place_is_named_for_what_it_is() {
    let folder = kinds();
    let at = folder.path();
    for (command, expected) in [
        (
            "estimate --vehicle d.log --out out.csv v.toml",
            "d.log: is a candump log; expected a vehicle file",
        ),
        (
            "estimate --vehicle t.csv --out out.csv d.log",
            "t.csv: is a signal table; expected a vehicle file",
        ),
        (
            "estimate --vehicle v.toml --out out.csv v.toml",
            "v.toml: is a vehicle file; expected a candump log",
        ),
        (
            "estimate --vehicle tuning.toml --out out.csv d.log",
            "tuning.toml: is a tuning file; expected a vehicle file",
        ),
        (
            "estimate --vehicle v.toml --tuning v.toml --out out.csv d.log",
            "v.toml: is a vehicle file; expected a tuning file",
        ),
        (
            "estimate --vehicle v.toml --out out.csv 0.csv",
            "0.csv: is a run (of `roadgrade estimate`); expected a signal table",
        ),
        (
            "inspect map.parquet",
            "map.parquet: is a Parquet file with no column time_s; expected time_s in the header",
        ),
        (
            "fuse --out out.csv map.csv",
            "map.csv: is a map (of `roadgrade fuse`); expected a run (of `roadgrade estimate`)",
        ),
        (
            "fuse --out out.csv t.csv",
            "t.csv: is a signal table; expected a run (of `roadgrade estimate`)",
        ),
        (
            "fuse --out out.csv d.log",
            "d.log: is a candump log; expected a run (of `roadgrade estimate`)",
        ),
        (
            "fuse --out out.csv --road t.csv 0.csv",
            "t.csv: is a signal table; expected a road",
        ),
        (
            "fuse --out out.csv --store map.csv 0.csv",
            "map.csv: is a map (of `roadgrade fuse`); expected the sums of a map",
        ),
        (
            "score --truth 0.csv --out out.csv 0.csv",
            "0.csv: is a run (of `roadgrade estimate`); expected a truth file",
        ),
        (
            "export 0.csv --out out.geojson",
            "0.csv: is a run (of `roadgrade estimate`); expected a map (of `roadgrade fuse`)",
        ),
        (
            "simulate --scenario v.toml --out out",
            "v.toml: is a vehicle file; expected a scenario file",
        ),
        (
            "import ztbus t.csv --out out",
            "t.csv: is a signal table; expected a ZTBus mission",
        ),
        (
            "diagnose --vehicle s.toml --out out t.csv",
            "s.toml: is a scenario file; expected a vehicle file",
        ),
    ] {
        says(at, command, expected);
    }
    assert!(!names(at).iter().any(|name| name.starts_with("out")));
}

#[test]
fn a_folder_in_place_of_a_file_is_named() {
    let folder = kinds();
    let at = folder.path();
    fs::create_dir(at.join("dir")).unwrap();
    for command in [
        "estimate --vehicle dir --out out.csv d.log",
        "estimate --vehicle v.toml --tuning dir --out out.csv d.log",
        "estimate --vehicle v.toml --kept dir --out out.csv d.log",
        "simulate --scenario dir --out out",
        "export dir --out out.geojson",
        "fuse --out out.csv --road dir 0.csv",
        "fuse --out out.csv --store dir 0.csv",
        "import ztbus dir --out out",
    ] {
        says(at, command, "dir: is a folder; expected a");
    }
    for command in [
        "estimate --vehicle v.toml --out out.csv dir",
        "score --truth dir --out out.csv 0.csv",
        "inspect dir",
    ] {
        says(at, command, "in this folder; expected at least one");
    }
}

#[test]
fn a_table_is_not_written_under_the_name_of_another_format() {
    let folder = kinds();
    let at = folder.path();
    for (command, expected) in [
        (
            "fuse --out m.geojson 0.csv",
            "m.geojson: ends in .geojson; expected .csv or .parquet; `roadgrade export` writes",
        ),
        (
            "fuse --out m.HTML 0.csv",
            "m.HTML: ends in .html; expected .csv or .parquet",
        ),
        (
            "fuse --out m.csv --store s.parquet 0.csv",
            "s.parquet: ends in .parquet; expected .csv",
        ),
        (
            "estimate --vehicle v.toml --out r.json d.log",
            "r.json: ends in .json; expected .csv or .parquet",
        ),
        (
            "score --truth 0.csv --out s.parquet 0.csv",
            "s.parquet: ends in .parquet; expected .csv",
        ),
        (
            "fuse --out m.v2 0.csv",
            "m.v2: ends in .v2; expected .csv or .parquet",
        ),
    ] {
        let words: Vec<&str> = command.split(' ').collect();
        let output = limited(at, &words);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains(expected), "{command}: {message}");
    }
    // A name without an ending is CSV.
    done(at, &["fuse", "--out", "m", "0.csv"]);
}

#[test]
fn a_misspelt_column_gets_the_names_that_are_like_it() {
    let folder = kinds();
    let at = folder.path();
    for (header, expected) in [
        ("time_s,wheel_speed", "such as `wheel_speed_mps`, "),
        ("time_s,gnss_altitude_m", "altitude_m"),
        ("time,wheel_speed_mps", "time_s"),
    ] {
        fs::write(at.join("x.csv"), format!("{header}\n0,1\n")).unwrap();
        says(at, "inspect x.csv", expected);
    }
    let run = fs::read_to_string(at.join("0.csv")).unwrap();
    fs::write(at.join("x.csv"), run.replacen("altitude_m", "height_m", 1)).unwrap();
    let expected = "x.csv:1: unknown column `height_m`; expected the columns of docs/formats.md";
    says(at, "fuse --out out.csv x.csv", expected);
}
