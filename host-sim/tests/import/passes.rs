//! Missions become passes and tables.

use crate::mission_maker::{MissionMaker, Point};
use crate::{check_pass_tables, columns, import};
use host_sim::files::vehicle::VehicleFile;
use predicates::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Returns a folder, the mission's file in it, and the path for its import.
fn folder_with(text: &str) -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("B183_2021-07-26_03-53-27.csv");
    fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    (folder, file, out)
}

struct Imported {
    passes: Vec<serde_json::Value>,
    out: PathBuf,
    _folder: TempDir,
}

impl Imported {
    fn of(text: &str) -> Self {
        let (folder, file, out) = folder_with(text);
        let run = import(&file, &out).arg("--json").assert().success();
        let json: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
        Self {
            passes: json["passes"].as_array().unwrap().clone(),
            out,
            _folder: folder,
        }
    }

    fn directions(&self) -> Vec<&str> {
        self.passes
            .iter()
            .map(|pass| pass["direction"].as_str().unwrap())
            .collect()
    }

    fn lengths_m(&self) -> Vec<f64> {
        self.passes
            .iter()
            .map(|pass| pass["length_m"].as_f64().unwrap())
            .collect()
    }
}

const GARAGE: Point = (-700.0, 1_900.0);
const A: Point = (0.0, 0.0);
const MIDDLE: Point = (1_400.0, 700.0);
const B: Point = (3_000.0, 1_500.0);
/// Length of the straight road from A to B, m.
const ROAD_M: f64 = 3_354.0;

/// Returns a mission from the garage, three times there and back, and home by another road.
fn there_and_back() -> String {
    let mut bus = MissionMaker::new(GARAGE, 40)
        .wait(60, 0)
        .drive(&[(-700.0, 0.0), A]);
    for trip in 0..3 {
        bus = bus
            .wait(150, 4 + trip)
            .drive(&[MIDDLE])
            .wait(25, 10)
            .drive(&[B])
            .wait(200, 20)
            .drive(&[MIDDLE])
            .wait(15, 8)
            .drive(&[A]);
    }
    bus.wait(130, 0)
        .drive(&[(300.0, -600.0), (-1_500.0, -600.0), GARAGE])
        .wait(60, 0)
        .text()
}

#[test]
fn three_round_trips_are_six_passes() {
    let imported = Imported::of(&there_and_back());
    assert_eq!(
        imported.directions(),
        [
            "outbound", "inbound", "outbound", "inbound", "outbound", "inbound"
        ]
    );
    for length_m in imported.lengths_m() {
        assert!((length_m - ROAD_M).abs() < 20.0, "{length_m}");
    }
    for (pass, climb_m) in imported.passes.iter().zip([60.0, -60.0].iter().cycle()) {
        let found_m = pass["climb_m"].as_f64().unwrap();
        assert!((found_m - climb_m).abs() < 1.0, "{found_m}");
    }
    check_pass_tables(&imported.passes);
    // The number of passengers is that of the last count. A pass starts with the count before it.
    let first = &imported.passes[0];
    let table = columns(Path::new(first["file"].as_str().unwrap()));
    let counts: Vec<&str> = table["passengers"].iter().map(String::as_str).collect();
    let at = counts.len() / 3;
    assert_eq!((counts[at], table["mass_kg"][at].as_str()), ("4", "19280"));
}

#[test]
fn the_whole_mission_is_a_signal_table_with_a_vehicle() {
    let text = there_and_back();
    let imported = Imported::of(&text);
    let table = columns(&imported.out.join("mission.csv"));
    assert_eq!(table["time_s"].len(), text.lines().count() - 1);
    for (name, expected) in [
        ("time_s", "0"),
        ("wheel_speed_mps", "0"),
        ("traction_force_n", "0"),
        ("brake", "1"),
        ("brake_pressure_pa", "240000"),
        ("ambient_celsius", "22"),
        ("mass_kg", "19000"),
        // Nothing was measured yet.
        ("latitude_deg", ""),
        ("longitude_deg", ""),
        ("altitude_m", ""),
        ("course_deg", ""),
        ("passengers", ""),
    ] {
        assert_eq!(table[name][0], expected, "{name}");
    }
    let moving = table["wheel_speed_mps"]
        .iter()
        .position(|speed| speed == "11")
        .unwrap();
    assert_eq!(table["brake"][moving], "0");
    assert_eq!(table["traction_force_n"][moving], "2500.5");
    assert_eq!(table["course_deg"][moving], "180", "southwards");
    let latitude_deg: f64 = table["latitude_deg"][moving].parse().unwrap();
    assert!((latitude_deg - 47.33).abs() < 0.05, "{latitude_deg}");
    let vehicle = VehicleFile::read(&imported.out.join("vehicle.toml")).unwrap();
    assert_eq!(vehicle.name, "ZTBus B183");
    assert_eq!(vehicle.model.vehicle.mass_kg, 19_000.0);
}

#[test]
fn the_table_lists_what_the_json_lists() {
    let (_folder, file, out) = folder_with(&there_and_back());
    import(&file, &out)
        .assert()
        .success()
        .stdout(predicate::str::contains("pass_06_inbound.csv"))
        .stdout(predicate::str::contains("direction"))
        .stderr(predicate::str::contains("first fix after 40 s"));
}

#[test]
fn the_same_mission_gives_the_same_bytes() {
    let (_folder, file, out) = folder_with(&there_and_back());
    let again = out.with_file_name("again");
    import(&file, &out).assert().success();
    import(&file, &again).assert().success();
    let mut names = 0;
    for entry in fs::read_dir(&out).unwrap() {
        let entry = entry.unwrap();
        let other = again.join(entry.file_name());
        assert!(fs::read(entry.path()).unwrap() == fs::read(other).unwrap());
        names += 1;
    }
    assert_eq!(names, 8, "mission, vehicle and six passes");
}

#[test]
fn a_bent_road_with_a_turning_loop_and_a_one_way_street_is_split_too() {
    let bend = (2_500.0, 0.0);
    let top = (2_500.0, 2_000.0);
    let out = [(800.0, 0.0), bend, top];
    // Around a block of 400 m, and back past a block with a one-way street.
    let back = [
        (2_700.0, 2_000.0),
        (2_700.0, 1_800.0),
        (2_500.0, 1_800.0),
        bend,
        (1_500.0, 0.0),
        (1_500.0, 200.0),
        (800.0, 200.0),
        (800.0, 0.0),
        A,
    ];
    let mut bus = MissionMaker::new(A, 0).wait(90, 0);
    for _ in 0..2 {
        bus = bus.drive(&out).wait(60, 0).drive(&back).wait(60, 0);
    }
    let imported = Imported::of(&bus.drive(&out).wait(60, 0).text());
    assert_eq!(
        imported.directions(),
        ["outbound", "inbound", "outbound", "inbound", "outbound"]
    );
    for (length_m, expected_m) in imported
        .lengths_m()
        .iter()
        .zip([4_500.0, 5_300.0].iter().cycle())
    {
        assert!((length_m - expected_m).abs() < 30.0, "{length_m}");
    }
    check_pass_tables(&imported.passes);
}

#[test]
fn a_change_of_route_is_no_pass() {
    let (c, d) = ((9_000.0, -4_000.0), (9_000.0, 1_000.0));
    let mut bus = MissionMaker::new(A, 0).wait(30, 0);
    for _ in 0..2 {
        bus = bus.drive(&[B]).wait(100, 0).drive(&[A]).wait(100, 0);
    }
    bus = bus.drive(&[(1_000.0, -4_000.0), c]).wait(100, 0);
    for _ in 0..2 {
        bus = bus.drive(&[d]).wait(100, 0).drive(&[c]).wait(100, 0);
    }
    let imported = Imported::of(&bus.text());
    let lengths_m = imported.lengths_m();
    assert_eq!(lengths_m.len(), 8, "{lengths_m:?}");
    for (index, length_m) in lengths_m.iter().enumerate() {
        let expected_m = if index < 4 { ROAD_M } else { 5_000.0 };
        assert!((length_m - expected_m).abs() < 30.0, "{lengths_m:?}");
    }
}

#[test]
fn one_round_trip_is_two_passes() {
    let bus = MissionMaker::new(A, 5).wait(30, 0);
    let text = bus.drive(&[B]).wait(100, 0).drive(&[A]).wait(20, 0).text();
    let imported = Imported::of(&text);
    assert_eq!(imported.directions(), ["outbound", "inbound"]);
    for length_m in imported.lengths_m() {
        assert!((length_m - ROAD_M).abs() < 100.0, "{length_m}");
    }
}

#[test]
fn a_drive_that_never_turns_back_is_one_pass_from_the_first_fix() {
    let square = [(2_000.0, 0.0), (2_000.0, 2_000.0), (0.0, 2_000.0), A];
    let text = MissionMaker::new(A, 50)
        .wait(30, 0)
        .drive(&square)
        .drive(&square)
        .text();
    let imported = Imported::of(&text);
    assert_eq!(imported.directions(), ["outbound"]);
    assert_eq!(imported.passes[0]["start_s"].as_f64(), Some(50.0));
    assert!(imported.lengths_m()[0] > 15_500.0);
    check_pass_tables(&imported.passes);
}
