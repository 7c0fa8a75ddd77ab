//! Studies of the thesis from the command line.

use predicates::prelude::*;
use std::fs;
use std::path::Path;
use test_kit::command::program;

fn study(name: &str, out: &Path, data: &Path) -> assert_cmd::assert::Assert {
    program()
        .args(["study", name, "--out"])
        .arg(out)
        .arg("--data")
        .arg(data)
        .assert()
}

#[test]
fn sensitivity_writes_its_page_table_and_both_figures() {
    let folder = tempfile::tempdir().unwrap();
    study("sensitivity", folder.path(), folder.path())
        .success()
        .stdout(predicate::str::contains("wheel radius"));
    let table = fs::read_to_string(folder.path().join("sensitivity.csv")).unwrap();
    assert!(table.contains("A,mass,-0.1667,-0.1667,"), "{table}");
    assert_eq!(table.lines().count(), 15);
    for name in ["sensitivity_A", "sensitivity_B"] {
        let svg = fs::read_to_string(folder.path().join(name).with_extension("svg")).unwrap();
        assert!(svg.contains("true grade (%)"), "{name}");
        let csv = fs::read_to_string(folder.path().join(name).with_extension("csv")).unwrap();
        // Seven parameters at 241 grades, and a header.
        assert_eq!(csv.lines().count(), 7 * 241 + 1, "{name}");
    }
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("figure 7"));
}

#[test]
fn without_measured_data_the_committed_chain_serves_and_the_page_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    study("gps", &out, folder.path()).success();
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("No measured mission in"), "{page}");
    let table = fs::read_to_string(out.join("gps_statistics.csv")).unwrap();
    assert!(table.contains("measured bus, generated"), "{table}");
    assert!(!table.contains("measured bus, training"), "{table}");
    assert!(table.contains("simulator, training"), "{table}");
}

#[test]
fn a_measured_mission_that_cannot_be_read_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("ztbus")).unwrap();
    fs::write(folder.path().join("ztbus/bad.csv"), "a,b\n1,2\n").unwrap();
    let out = folder.path().join("out");
    study("gps", &out, folder.path())
        .code(1)
        .stderr(predicate::str::contains("bad.csv"));
    assert!(!out.join("report.html").exists());
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let page = |name: &str| {
        let out = folder.path().join(name);
        study("gps", &out, folder.path()).success();
        fs::read(out.join("report.html")).unwrap()
    };
    assert_eq!(page("one"), page("two"));
}

#[test]
fn the_measured_car_is_judged_by_its_accelerometer() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    if !data.join("i3").exists() {
        eprintln!("SKIPPED: no measured data at ../shared/data/i3");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    study("i3", folder.path(), &data).success();
    let table = |name: &str| -> Vec<Vec<String>> {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        let rows = csv::Reader::from_reader(text.as_bytes()).into_records();
        rows.map(|row| row.unwrap().iter().map(str::to_owned).collect())
            .collect()
    };
    let number = |text: &str| -> f64 { text.parse().unwrap() };
    // The floor: far below what is judged.
    let floor = table("i3_floor.csv");
    assert!(floor.len() > 10, "{floor:?}");
    for pair in &floor[..floor.len() - 1] {
        assert!((0.03..0.25).contains(&number(&pair[5])), "{pair:?}");
    }
    let groups = table("i3_groups.csv");
    let rms = |group: &str, what: &str| -> f64 {
        let is_it = |row: &&Vec<String>| row[0] == "300" && row[1] == group && row[2] == what;
        number(&groups.iter().find(is_it).unwrap()[4])
    };
    for group in ["summer", "winter"] {
        let (smoothed, live) = (rms(group, "smoothed"), rms(group, "live"));
        let elevation = rms(group, "elevation");
        assert!(
            smoothed < live && live < elevation,
            "{group}: {smoothed} {live} {elevation}"
        );
        assert!(smoothed < 0.45, "{group}: {smoothed}");
    }
    assert_eq!(table("i3_trips.csv").len(), 25);
    // What was found makes the estimates better, and the seasons alike.
    let effects = table("i3_effects.csv");
    let of = |group: &str, column: usize| -> f64 {
        let is_it = |row: &&Vec<String>| row[0] == group && row[1] == "smoothed";
        number(&effects.iter().find(is_it).unwrap()[column])
    };
    let (before, after) = (3, 4);
    for group in ["summer", "winter"] {
        assert!(of(group, after) < of(group, before), "{group}");
    }
    let (bias_before, bias_after) = (9, 10);
    let between = |column: usize| of("winter", column) - of("summer", column);
    assert!(between(bias_after).abs() < 0.5 * between(bias_before).abs());
}

#[test]
fn without_a_car_its_study_says_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    study("i3", &out, folder.path())
        .code(1)
        .stderr(predicate::str::contains("no i3/Trip*.csv.gz"));
    assert!(!out.exists());
}

#[test]
fn without_its_road_the_study_of_the_road_says_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    study("e4", &out, folder.path())
        .code(1)
        .stderr(predicate::str::contains("e4/road.csv is missing; expected"));
    assert!(!out.exists());
    // A road that is too short for the thesis's.
    fs::create_dir(folder.path().join("e4")).unwrap();
    let road = "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent\n\
                0,59.0,17.0,35,1\n100,59.0009,17.0,36,1\n";
    fs::write(folder.path().join("e4/road.csv"), road).unwrap();
    study("e4", &out, folder.path())
        .code(1)
        .stderr(predicate::str::contains(
            "0.1 km long; expected at least 47 km",
        ));
}
