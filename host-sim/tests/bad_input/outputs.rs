//! Outputs that are inputs too, under any name, and copies of what was fitted.

use crate::shell::{done, names, refused, runs};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

const VEHICLE: &str = "[vehicle]\nname = \"A\"\nmass_kg = 39000.0\ndrag_area_m2 = 6.0\n\
    rolling_resistance = 0.0065\nwheel_radius_m = 0.5\nwheel_inertia_kgm2 = 100.0\n\
    [traction]\nsource = \"force\"\n";

/// A drive over hills, one row a second.
fn write_log(path: &Path, km: usize, shift: f64) {
    let mut text = String::from(
        "time_s,wheel_speed_mps,traction_force_n,latitude_deg,longitude_deg,altitude_m\n",
    );
    for second in 0..km * 40 {
        let at_m = 25.0 * second as f64;
        let altitude_m = 400.0 + 30.0 * (at_m / 1_000.0).sin() + shift;
        let force_n = 4_700.0 + 39_000.0 * 9.81 * 0.03 * (at_m / 1_000.0).cos();
        let latitude_deg = 47.0 + at_m / 111e3;
        text += &format!("{second}.0,25.0,{force_n:.0},{latitude_deg:.7},8.5,{altitude_m:.2}\n");
    }
    fs::write(path, text).unwrap();
}

#[test]
fn no_command_writes_over_its_input() {
    let folder = runs(40, 2);
    let at = folder.path();
    fs::write(at.join("vehicle.toml"), VEHICLE).unwrap();
    write_log(&at.join("d.csv"), 1, 0.0);
    done(at, &["fuse", "--out", "map.csv", "0.csv"]);
    let scenario = "[road]\nlength_m = 1000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    fs::write(at.join("road.csv"), scenario).unwrap();
    let truth = "time_s,distance_m,grade_percent,altitude_m,shifting,braking\n0,0,1,4,0,0\n";
    fs::write(at.join("t.csv"), truth).unwrap();
    symlink("d.csv", at.join("link.csv")).unwrap();
    fs::hard_link(at.join("d.csv"), at.join("twin.csv")).unwrap();
    fs::hard_link(at.join("map.csv"), at.join("map.geojson")).unwrap();
    fs::hard_link(at.join("0.csv"), at.join("run.csv")).unwrap();
    let content = || -> Vec<(String, Vec<u8>)> {
        let read = |name: String| (name.clone(), fs::read(at.join(name)).unwrap());
        names(at).into_iter().map(read).collect()
    };
    let before = content();
    let cases: [&[&str]; 17] = [
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "d.csv",
            "d.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "link.csv",
            "d.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "twin.csv",
            "d.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "d.csv",
            "link.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "vehicle.toml",
            "d.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "r",
            "--kept",
            "d.csv",
            "d.csv",
        ],
        &[
            "estimate",
            "--vehicle",
            "vehicle.toml",
            "--out",
            "r",
            "--kept",
            "r",
            "d.csv",
        ],
        &["fuse", "--out", "0.csv", "0.csv", "1.csv"],
        &["fuse", "--out", "run.csv", "0.csv", "1.csv"],
        &["fuse", "--out", "m.csv", "--store", "run.csv", "0.csv"],
        &["fuse", "--out", "0.csv", "--session", "x=1.csv,./0.csv"],
        &["export", "map.csv", "--out", "map.geojson"],
        &["export", "map.csv", "--out", "."],
        &["score", "--truth", "t.csv", "--out", "t.csv", "0.csv"],
        &["score", "--truth", "t.csv", "--out", "run.csv", "0.csv"],
        &[
            "diagnose",
            "--vehicle",
            "vehicle.toml",
            "--out",
            ".",
            "d.csv",
        ],
        &["simulate", "--scenario", "road.csv", "--out", "."],
    ];
    for arguments in cases {
        let message = refused(at, arguments);
        assert!(message.contains(" too"), "{arguments:?}: {message}");
        assert!(content() == before, "{arguments:?}");
    }
    // A folder of runs may have the map of the last time; it may not lose a run.
    refused(at, &["fuse", "--out", "1.csv", "."]);
    done(at, &["fuse", "--out", "map.csv", "."]);
}

#[test]
fn a_copy_of_a_fitted_drive_is_not_held_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("v.toml"), VEHICLE).unwrap();
    write_log(&at.join("a.csv"), 3, 0.0);
    write_log(&at.join("b.csv"), 3, 0.5);
    fs::copy(at.join("a.csv"), at.join("copy.csv")).unwrap();
    let text = fs::read_to_string(at.join("a.csv")).unwrap();
    fs::write(at.join("spaced.csv"), text.replace(',', " , ")).unwrap();
    for copy in ["copy.csv", "spaced.csv"] {
        let arguments = [
            "diagnose",
            "--vehicle",
            "v.toml",
            "--out",
            "found",
            "a.csv",
            "b.csv",
        ];
        let message = refused(at, &[&arguments[..], &["--holdout", copy]].concat());
        assert!(
            message.contains(&format!("{copy}: the same drive as a.csv")),
            "{message}"
        );
        assert!(!at.join("found").exists());
    }
}
